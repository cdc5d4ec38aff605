#include "engine/scene/rules.h"

#include <algorithm>

#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

void check_group(const KeyGroup& group, const Json& json, const Place& place) {
    std::vector<std::string> present;
    for (const std::string& key : group.keys)
        if (json.contains(key)) present.push_back(key);
    const std::string all = listed(group.keys);
    switch (group.kind) {
        case KeyGroup::Kind::exactly_one:
            if (present.size() == 1) return;
            place.refuse(present.empty() ? "none of the keys" : "the keys " + listed(present),
                         "exactly one of the keys " + all);
        case KeyGroup::Kind::at_most_one:
            if (present.size() <= 1) return;
            place.refuse("the keys " + listed(present), "at most one of the keys " + all);
        case KeyGroup::Kind::together:
            if (present.empty() || present.size() == group.keys.size()) return;
            place.refuse("only " + listed(present), "all of the keys " + all + ", or none of them");
    }
}

Json group_schema(const KeyGroup& group) {
    Json one_each = Json::array(), pairs = Json::array(), needs = Json::object();
    for (const std::string& key : group.keys) {
        one_each.push_back(object_of({{"required", Json::array({key})}}));
        Json others = Json::array();
        for (const std::string& other : group.keys)
            if (other != key) others.push_back(other);
        needs[key] = others;
        for (const std::string& other : group.keys)
            if (key < other) pairs.push_back(object_of({{"required", Json::array({key, other})}}));
    }
    switch (group.kind) {
        case KeyGroup::Kind::exactly_one:
            return object_of({{"oneOf", one_each}});
        case KeyGroup::Kind::at_most_one:
            return object_of({{"not", object_of({{"anyOf", pairs}})}});
        case KeyGroup::Kind::together:
            return object_of({{"dependentRequired", needs}});
    }
    return {};
}

}  // namespace

RuleTable::RuleTable(const char* name, const char* meaning) : name_(name), meaning_(meaning) {}
RuleTable::RuleTable(const RuleTable& other) = default;
RuleTable::~RuleTable() = default;

void RuleTable::add_key(std::string_view name, const KeyDoc& doc, std::size_t offset, const ValueFunctions& value) {
    keys_.push_back({std::string(name), doc, offset, value});
}

void RuleTable::add_group(KeyGroup::Kind kind, KeyNames keys) {
    groups_.push_back({kind, std::vector<std::string>(keys.begin(), keys.end())});
}

const RuleTable::Key* RuleTable::find(const std::string& name) const {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) {
        return k.name == name || (!k.doc.alias.empty() && k.doc.alias == name);
    });
    return key == keys_.end() ? nullptr : &*key;
}

std::vector<std::string> RuleTable::known_names() const {
    std::vector<std::string> names;
    for (const Key& key : keys_) {
        names.push_back(key.name);
        if (!key.doc.alias.empty()) names.emplace_back(key.doc.alias);
    }
    return names;
}

void RuleTable::refuse_withdrawn(const std::string& key, const Place& place) const {
    for (const Withdrawn& old : withdrawn_)
        if (old.key == key)
            place.key(key).refuse("a key that no longer exists", "a scene without this key", std::string(old.instead));
}

Place RuleTable::place_of(const Json& json, const Place& outer) const {
    if (!json.is_object()) outer.refuse(described(json), "an object with keys such as " + listed(known_names()));
    if (const auto own = json.find("name"); own != json.end() && own->is_string())
        return outer.of(name_ + " " + in_quotes(own->get_ref<const std::string&>()));
    return outer;
}

void RuleTable::read_object(const Json& json, const Place& outer, void* object) const {
    const Place place = place_of(json, outer);
    read_keys(json, place, object);
    for (const auto& check : checks_) check(place, object);
    if (place_offset_) *reinterpret_cast<Place*>(static_cast<std::byte*>(object) + *place_offset_) = place;
}

void RuleTable::read_keys(const Json& json, const Place& place, void* object) const {
    std::vector<std::string> seen;
    for (const auto& [name, value] : json.items()) {
        refuse_withdrawn(name, place);
        const Key* key = find(name);
        if (key == nullptr) {
            const std::vector<std::string> names = known_names();
            place.key(name).refuse("an unknown key", "one of the keys " + listed(names), nearest_hint(name, names));
        }
        if (std::find(seen.begin(), seen.end(), key->name) != seen.end())
            place.key(name).refuse("both " + in_quotes(key->name) + " and " + in_quotes(key->doc.alias),
                                   "only one of the two keys, because they mean the same");
        seen.push_back(key->name);
    }
    for (const Key& key : keys_)
        if (key.doc.required && std::find(seen.begin(), seen.end(), key.name) == seen.end())
            place.refuse("no key " + in_quotes(key.name),
                         "the key " + in_quotes(key.name) + ": " + std::string(key.doc.meaning));
    for (const KeyGroup& group : groups_) check_group(group, json, place);
    // Values are read in table order, not in file order. If a file has several mistakes, the reported one does not
    // depend on the order of keys in the file.
    for (const Key& key : keys_)
        for (const auto& [name, value] : json.items())
            if (find(name) == &key)
                key.value.read(value, place.key(name), key.doc, static_cast<std::byte*>(object) + key.offset);
}

Json RuleTable::schema(SchemaBook& book) const {
    Json schema = object_of({{"type", "object"}, {"description", meaning_}, {"additionalProperties", false}});
    Json properties = Json::object(), required = Json::array(), all = Json::array();
    for (const Key& key : keys_) {
        Json property = key.value.describe(book, key.doc);
        std::string description(key.doc.meaning);
        if (!key.doc.unit.empty()) description.append(" [").append(key.doc.unit).append("]");
        property["description"] = std::move(description);
        properties[key.name] = property;
        if (!key.doc.alias.empty()) {
            const std::string alias(key.doc.alias);
            property["description"] = "Another name for " + key.name + ".";
            properties[alias] = property;
            all.push_back(group_schema(
                {key.doc.required ? KeyGroup::Kind::exactly_one : KeyGroup::Kind::at_most_one, {key.name, alias}}));
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

void check_keys_of_kind(const Place& place, const std::string& kind, const KeysOfKind& keys,
                        const std::vector<std::pair<std::string, bool>>& given, const char* no_keys) {
    for (const auto& [key, is_given] : given) {
        const bool required = std::ranges::find(keys.required, key) != keys.required.end();
        if (required && !is_given)
            place.refuse("no key " + in_quotes(key), "the key " + in_quotes(key) + ", which " + kind + " requires");
        if (!is_given || required || std::ranges::find(keys.optional, key) != keys.optional.end()) continue;
        std::vector<std::string> possible = keys.required;
        possible.insert(possible.end(), keys.optional.begin(), keys.optional.end());
        place.key(key).refuse("a key that is not used by " + kind,
                              possible.empty() ? no_keys : "one of the keys " + listed(possible));
    }
}

}  // namespace skerry
