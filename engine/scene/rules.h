// Rules: descriptions of the keys of an object in a scene file. Reading, the check for unknown keys and the schema all
// use the same description.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/row_type.h"
#include "components/types.h"
#include "engine/scene/place.h"

namespace skerry {

/// Bounds of a number, or of each number in a vector or a list.
struct Limits {
    std::optional<Real> at_least, above, at_most, below;
};
constexpr Limits at_least(Real bound) {
    return {.at_least = bound, .above = {}, .at_most = {}, .below = {}};
}
constexpr Limits above(Real bound) {
    return {.at_least = {}, .above = bound, .at_most = {}, .below = {}};
}
constexpr Limits within(Real lower, Real upper) {
    return {.at_least = lower, .above = {}, .at_most = upper, .below = {}};
}

/// Documentation of a key in a scene file. Only views of the texts are stored, so the texts must exist until the
/// program ends.
struct KeyDoc {
    std::string_view meaning;
    std::string_view unit = {};   // SI unit
    std::string_view alias = {};  // alternative name
    Limits limits = {};
    bool required = false;
};

/// Definitions of a JSON schema by name, in order of first use.
using SchemaBook = Json;

/// Reads a value of a C++ type from JSON and describes the type in a schema. values.h has the specialisations for
/// simple types. All other types are objects with a Rule.
template <class T>
struct Value;

/// A key that was removed from the format, and a hint that names its replacement.
struct Withdrawn {
    std::string_view key, instead;
};

using KeyNames = std::initializer_list<std::string_view>;

/// A condition on several keys of an object: exactly one, at most one, or either all or none of them must be given.
struct KeyGroup {
    enum class Kind { exactly_one, at_most_one, together } kind;
    std::vector<std::string> keys;
};

/// Part of a rule that does not depend on the type of the object. This part is compiled only once, in rules.cpp.
class RuleTable {
public:
    const std::string& name() const { return name_; }
    Json schema(SchemaBook& book) const;

protected:
    /// Functions that read the value of a key from JSON and describe the type of the value in a schema.
    struct ValueFunctions {
        void (*read)(const Json&, const Place&, const KeyDoc&, void* value);
        Json (*describe)(SchemaBook&, const KeyDoc&);
    };
    struct Key {
        std::string name;
        KeyDoc doc;
        std::size_t offset;  // offset of the key's value within the C++ object [bytes]
        ValueFunctions value;
    };

    RuleTable(const char* name, const char* meaning);
    RuleTable(const RuleTable& other);
    ~RuleTable();

    void add_key(std::string_view name, const KeyDoc& doc, std::size_t offset, const ValueFunctions& value);
    void add_group(KeyGroup::Kind kind, KeyNames keys);
    void add_withdrawn(const Withdrawn& withdrawn) { withdrawn_.push_back(withdrawn); }
    void add_check(std::function<void(const Place&, const void*)> check) { checks_.push_back(std::move(check)); }
    /// Sets the offset of the member `place` of an object [bytes]. read_object() stores the object's location in the
    /// file there.
    void store_place_at(std::size_t offset) { place_offset_ = offset; }
    /// Reads the values of all keys of an object. Throws SceneError if the JSON value is not an object, or if it
    /// violates the rule.
    void read_object(const Json& json, const Place& outer, void* object) const;

private:
    /// Returns the location of the object in the file, with the object's own name if it has one.
    Place place_of(const Json& json, const Place& outer) const;
    void read_keys(const Json& json, const Place& place, void* object) const;
    const Key* find(const std::string& name) const;
    std::vector<std::string> known_names() const;
    void refuse_withdrawn(const std::string& key, const Place& place) const;

    std::string name_, meaning_;
    std::vector<Key> keys_;
    std::vector<KeyGroup> groups_;
    std::vector<Withdrawn> withdrawn_;
    std::vector<std::function<void(const Place&, const void*)>> checks_;
    std::optional<std::size_t> place_offset_;  // see store_place_at(); empty: the object has no such member
};

template <class V>
void read_value(const Json& json, const Place& place, const KeyDoc& doc, void* value) {
    Value<V>::read(json, place, doc, *static_cast<V*>(value));
}

/// Rule for the objects of type T in a scene file.
template <class T>
class Rule : public RuleTable {
public:
    /// `name` is the title of the definition in the schema. In error messages it precedes the object's own name.
    Rule(const char* name, const char* meaning) : RuleTable(name, meaning) {
        if constexpr (requires(T object) { object.place; })
            store_place_at(member_offset(static_cast<Place T::*>(&T::place)));
    }

    /// Adds a key whose value is stored in `member`. `Base`: T, or a base class of T.
    template <class V, class Base>
    Rule& key(std::string_view name, V Base::*member, const KeyDoc& doc) {
        add_key(name, doc, member_offset(static_cast<V T::*>(member)), {read_value<V>, Value<V>::schema});
        return *this;
    }
    /// Adds a key whose value can set all members of the object, such as the name of a material to copy. Keys are read
    /// in the order in which they were added, so keys added later can replace single members. Preset: type with
    /// Value<Preset>, which reads the value into an object of type T.
    template <class Preset>
    Rule& preset(std::string_view name, const KeyDoc& doc) {
        add_key(name, doc, 0, {read_preset<Preset>, Value<Preset>::schema});
        return *this;
    }
    Rule& exactly_one(KeyNames keys) { return group(KeyGroup::Kind::exactly_one, keys); }
    Rule& at_most_one(KeyNames keys) { return group(KeyGroup::Kind::at_most_one, keys); }
    Rule& together(KeyNames keys) { return group(KeyGroup::Kind::together, keys); }
    /// Declares a removed key. Reading such a key throws SceneError with a hint that names the replacement.
    Rule& withdrawn(std::string_view key, std::string_view instead) {
        add_withdrawn({key, instead});
        return *this;
    }
    /// Adds a check of an object after its keys were read. `condition` must throw SceneError for invalid values.
    Rule& check(void (*condition)(const Place&, const T&)) {
        add_check(
            [condition](const Place& place, const void* object) { condition(place, *static_cast<const T*>(object)); });
        return *this;
    }

    void read(const Json& json, const Place& outer, T& object) const { read_object(json, outer, &object); }

private:
    template <class Preset>
    static void read_preset(const Json& json, const Place& place, const KeyDoc& doc, void* object) {
        Value<Preset>::read(json, place, doc, *static_cast<T*>(object));
    }
    Rule& group(KeyGroup::Kind kind, KeyNames keys) {
        add_group(kind, keys);
        return *this;
    }
};

/// Returns the complete JSON schema for files that contain one object with the given rule.
std::string schema_document(const std::string& title, const RuleTable& rule);

/// Returns the rule for objects of type T. scene_rules.h declares most specialisations.
template <class T>
const Rule<T>& rule_of();

}  // namespace skerry
