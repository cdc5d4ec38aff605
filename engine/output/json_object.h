// JSON documents that keep the order of their keys.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

namespace skerry {

/// JSON document that keeps the order of its keys. A document that was read keeps the order of the file. A generated
/// schema has the order of the tables that define its keys. Numbers that are not finite become null.
using Json = nlohmann::ordered_json;

/// A key of a JSON object, and its value.
struct JsonMember {
    const char* key;
    mutable Json value;  // mutable: object_of() moves it out of a const initializer list
};
/// Returns the JSON object with these members. The initializer-list constructor of nlohmann::json gives the same
/// object, but compiles to several times as much code at each call.
inline Json object_of(std::initializer_list<JsonMember> members) {
    Json::object_t object;
    for (const JsonMember& member : members) object.emplace(member.key, std::move(member.value));
    return object;
}

}  // namespace skerry
