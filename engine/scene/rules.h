// The keys of an object in a scene file, described once. Reading, the check for unknown keys and the schema all come
// from that description.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/types.h"
#include "engine/scene/place.h"

namespace skerry {

/// Bounds of a number, of each number of a vector, or of the length of a list or text.
struct Limits {
    std::optional<Real> at_least, above, at_most, below;
};
inline Limits at_least(Real bound) {
    return {.at_least = bound, .above = {}, .at_most = {}, .below = {}};
}
inline Limits above(Real bound) {
    return {.at_least = {}, .above = bound, .at_most = {}, .below = {}};
}
inline Limits within(Real lower, Real upper) {
    return {.at_least = lower, .above = {}, .at_most = upper, .below = {}};
}

/// What is said of a key.
struct KeyDoc {
    std::string meaning;
    std::string unit = {};   // SI
    std::string alias = {};  // a second name
    Limits limits = {};
    bool required = false;
};

/// Definitions of a schema, by name, in the order met.
using SchemaBook = Json;

/// How a C++ type is read from JSON and described in a schema. Specialised in values.h; anything else is an object that
/// has a Rule.
template <class T>
struct Value;

/// What keys of an object have to do with each other.
struct KeyGroup {
    enum class Kind { exactly_one, at_most_one, together } kind;
    std::vector<std::string> keys;
};

/// The keys of objects of type T.
template <class T>
class Rule {
public:
    /// `name` heads the definition in the schema and, with the object's own name, messages.
    Rule(std::string name, std::string meaning) : name_(std::move(name)), meaning_(std::move(meaning)) {}

    template <class V>
    Rule& key(std::string name, V T::*member, KeyDoc doc) {
        keys_.push_back({std::move(name), doc,
                         [member, doc](const Json& json, const Place& place, T& object) {
                             Value<V>::read(json, place, doc, object.*member);
                         },
                         [doc](SchemaBook& book) { return Value<V>::schema(book, doc); }});
        return *this;
    }
    Rule& exactly_one(std::vector<std::string> keys) { return group(KeyGroup::Kind::exactly_one, std::move(keys)); }
    Rule& at_most_one(std::vector<std::string> keys) { return group(KeyGroup::Kind::at_most_one, std::move(keys)); }
    Rule& together(std::vector<std::string> keys) { return group(KeyGroup::Kind::together, std::move(keys)); }
    /// A condition between values; it refuses by itself.
    Rule& check(std::function<void(const Place&, const T&)> check) {
        checks_.push_back(std::move(check));
        return *this;
    }

    const std::string& name() const { return name_; }
    void read(const Json& json, const Place& place, T& object) const;
    Json schema(SchemaBook& book) const;

private:
    struct Key {
        std::string name;
        KeyDoc doc;
        std::function<void(const Json&, const Place&, T&)> read;
        std::function<Json(SchemaBook&)> schema;
    };

    Rule& group(KeyGroup::Kind kind, std::vector<std::string> keys) {
        groups_.push_back({kind, std::move(keys)});
        return *this;
    }
    const Key* find(const std::string& name) const {
        const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) {
            return k.name == name || (!k.doc.alias.empty() && k.doc.alias == name);
        });
        return key == keys_.end() ? nullptr : &*key;
    }
    std::vector<std::string> known_names() const {
        std::vector<std::string> names;
        for (const Key& key : keys_) {
            names.push_back(key.name);
            if (!key.doc.alias.empty()) names.push_back(key.doc.alias);
        }
        return names;
    }

    std::string name_, meaning_;
    std::vector<Key> keys_;
    std::vector<KeyGroup> groups_;
    std::vector<std::function<void(const Place&, const T&)>> checks_;
};

/// The rule of a type; specialised in scene_rules.cpp.
template <class T>
const Rule<T>& rule_of();

void check_group(const KeyGroup& group, const Json& json, const Place& place);
Json group_schema(const KeyGroup& group);

template <class T>
void Rule<T>::read(const Json& json, const Place& outer, T& object) const {
    if (!json.is_object()) outer.refuse(described(json), "an object: " + name_);
    Place place = outer;
    if (const auto own = json.find("name"); own != json.end() && own->is_string())
        place = outer.of(name_ + " " + in_quotes(own->template get_ref<const std::string&>()));
    std::vector<std::string> seen;
    for (const auto& [name, value] : json.items()) {
        const Key* key = find(name);
        if (key == nullptr) {
            const std::vector<std::string> names = known_names();
            place.key(name).refuse("an unknown key", "one of " + listed(names), nearest_hint(name, names));
        }
        if (std::find(seen.begin(), seen.end(), key->name) != seen.end())
            place.key(name).refuse("both " + in_quotes(key->name) + " and " + in_quotes(key->doc.alias),
                                   "one of them: they mean the same");
        seen.push_back(key->name);
    }
    for (const Key& key : keys_)
        if (key.doc.required && std::find(seen.begin(), seen.end(), key.name) == seen.end())
            place.refuse("no key " + in_quotes(key.name), in_quotes(key.name) + ": " + key.doc.meaning);
    for (const KeyGroup& group : groups_) check_group(group, json, place);
    // Table order, not file order, so that of several mistakes the same one is named whatever the order of keys.
    for (const Key& key : keys_)
        for (const auto& [name, value] : json.items())
            if (find(name) == &key) key.read(value, place.key(name), object);
    for (const auto& check : checks_) check(place, object);
    if constexpr (requires { object.place; }) object.place = place;
}

template <class T>
Json Rule<T>::schema(SchemaBook& book) const {
    Json schema = {{"type", "object"}, {"description", meaning_}, {"additionalProperties", false}};
    Json properties = Json::object(), required = Json::array(), all = Json::array();
    for (const Key& key : keys_) {
        Json property = key.schema(book);
        property["description"] = key.doc.meaning + (key.doc.unit.empty() ? "" : " [" + key.doc.unit + "]");
        properties[key.name] = property;
        if (!key.doc.alias.empty()) {
            property["description"] = "The same as " + key.name + ".";
            properties[key.doc.alias] = property;
            all.push_back(group_schema({key.doc.required ? KeyGroup::Kind::exactly_one : KeyGroup::Kind::at_most_one,
                                        {key.name, key.doc.alias}}));
        } else if (key.doc.required) {
            required.push_back(key.name);
        }
    }
    schema["properties"] = properties;
    if (!required.empty()) schema["required"] = required;
    for (const KeyGroup& group : groups_) all.push_back(group_schema(group));
    if (!all.empty()) schema["allOf"] = all;
    return schema;
}

}  // namespace skerry
