// Functions that read values of each type from JSON and describe the types in the schema.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/options.h"
#include "engine/scene/rules.h"
#include "jobs/function_ref.h"
#include "skerry/time_table.h"

namespace skerry {

/// A path in a scene file. A relative path starts at the folder of the scene file.
struct FilePath {
    std::filesystem::path path;
};
/// A rotation, stored as axis times angle. A scene file gives it as an axis with an angle in degrees or in radians, or
/// as the rows of a matrix.
struct Rotation {
    Vec3 value = Vec3::Zero();  // [rad]
};
/// A list of objects with names, in the order of the file.
template <class T>
struct Named {
    std::vector<std::pair<std::string, T>> items;
};
/// A single object or a list of objects.
template <class T>
struct OneOrMore {
    std::vector<T> items;
};
/// A rotation that a scene file gives as the rows of a 3 x 3 matrix.
struct RotationRows {
    Vec3 value = Vec3::Zero();  // rotation axis times angle [rad]
};

Real read_number(const Json& json, const Place& place, const KeyDoc& doc);
Json number_schema(const char* type, const KeyDoc& doc);
Json text_schema();
Json boolean_schema();
Json enum_schema(const std::vector<std::string>& names);
Json list_schema(Json items);
Json list_schema(Json items, std::size_t count);
Json named_schema(Json value);
Json either_schema(Json one, Json other);
/// Returns a schema reference to the definition of a rule. Adds the definition to `book` if `book` lacks it.
Json rule_schema(SchemaBook& book, const RuleTable& rule);

template <>
struct Value<bool> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, bool& out);
    static Json schema(SchemaBook&, const KeyDoc&) { return boolean_schema(); }
};
template <>
struct Value<Real> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Real& out) {
        out = read_number(json, place, doc);
    }
    static Json schema(SchemaBook&, const KeyDoc& doc) { return number_schema("number", doc); }
};
template <>
struct Value<int> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, int& out);
    static Json schema(SchemaBook&, const KeyDoc& doc) { return number_schema("integer", doc); }
};
template <>
struct Value<std::uint32_t> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::uint32_t& out);
    static Json schema(SchemaBook&, const KeyDoc& doc) { return number_schema("integer", doc); }
};
template <>
struct Value<std::string> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::string& out);
    static Json schema(SchemaBook&, const KeyDoc&) { return text_schema(); }
};
template <>
struct Value<FilePath> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, FilePath& out);
    static Json schema(SchemaBook&, const KeyDoc&) { return text_schema(); }
};
template <>
struct Value<RotationRows> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, RotationRows& out);
    static Json schema(SchemaBook& book, const KeyDoc& doc);
};
template <>
struct Value<Rotation> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Rotation& out);
    static Json schema(SchemaBook& book, const KeyDoc& doc);
};

/// A value over time: a number if it is constant, or a list of pairs [time, value]. The limits of the key apply to each
/// value.
template <>
struct Value<TimeTable> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, TimeTable& out);
    static Json schema(SchemaBook& book, const KeyDoc& doc);
};

void check_count(const Json& json, const Place& place, std::size_t count, const char* of_what);

template <class T, std::size_t N>
struct Value<std::array<T, N>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::array<T, N>& out) {
        check_count(json, place, N, std::is_arithmetic_v<T> ? "numbers" : "texts");
        for (std::size_t i = 0; i < N; ++i) Value<T>::read(json[i], place.item(i), doc, out[i]);
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return list_schema(Value<T>::schema(book, doc), N); }
};
template <>
struct Value<Vec3> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Vec3& out) {
        std::array<Real, 3> numbers{};
        Value<std::array<Real, 3>>::read(json, place, doc, numbers);
        out = Vec3(numbers[0], numbers[1], numbers[2]);
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return Value<std::array<Real, 3>>::schema(book, doc); }
};

/// Reads a text, and returns the index of this text in `names`. Throws SceneError if `names` does not have it.
/// `hint_for_removed`: returns the hint for the message if its argument is a name that is no longer accepted, else an
/// empty text.
std::size_t read_name(const Json& json, const Place& place, const std::vector<std::string>& names,
                      std::string_view (*hint_for_removed)(std::string_view));

/// Reads a value of an enum from its name.
template <class Enum>
requires std::is_enum_v<Enum>
struct Value<Enum> {
    static std::vector<std::string> names() {
        std::vector<std::string> list;
        for (const auto& [value, name] : EnumNames<Enum>::table) list.emplace_back(name);
        return list;
    }
    static void read(const Json& json, const Place& place, const KeyDoc&, Enum& out) {
        out = EnumNames<Enum>::table[read_name(json, place, names(), hint_for_removed<Enum>)].first;
    }
    static Json schema(SchemaBook&, const KeyDoc&) { return enum_schema(names()); }
};

template <class T>
struct Value<std::optional<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::optional<T>& out) {
        Value<T>::read(json, place, doc, out.emplace());
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return Value<T>::schema(book, doc); }
};
/// Calls item(value, place) for each item of a JSON list.
void read_items(const Json& json, const Place& place, FunctionRef<void(const Json&, const Place&)> item);

/// Appends the items of a list to `out`. If a scene includes other scenes, `out` already has the items of the included
/// scenes.
template <class T>
struct Value<std::vector<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::vector<T>& out) {
        read_items(json, place,
                   [&](const Json& value, const Place& at) { Value<T>::read(value, at, doc, out.emplace_back()); });
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return list_schema(Value<T>::schema(book, doc)); }
};
template <class T>
struct Value<OneOrMore<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, OneOrMore<T>& out) {
        if (json.is_array())
            Value<std::vector<T>>::read(json, place, doc, out.items);
        else
            Value<T>::read(json, place, doc, out.items.emplace_back());
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) {
        return either_schema(Value<T>::schema(book, doc), Value<std::vector<T>>::schema(book, doc));
    }
};
/// Calls item(name, value, place) for each key of a JSON object. Throws SceneError if `has` returns true for a name,
/// which means that an included scene has already used the name.
void read_named(const Json& json, const Place& place, FunctionRef<bool(const std::string&)> has,
                FunctionRef<void(const std::string&, const Json&, const Place&)> item);

template <class T>
struct Value<Named<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Named<T>& out) {
        read_named(
            json, place,
            [&](const std::string& name) {
                for (const auto& item : out.items)
                    if (item.first == name) return true;
                return false;
            },
            [&](const std::string& name, const Json& value, const Place& at) {
                Value<T>::read(value, at, doc, out.items.emplace_back(name, T{}).second);
            });
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return named_schema(Value<T>::schema(book, doc)); }
};

/// Reads a value of a type that has no specialisation above. Such a value is an object with a Rule.
template <class T>
struct Value {
    static void read(const Json& json, const Place& place, const KeyDoc&, T& out) {
        rule_of<T>().read(json, place, out);
    }
    static Json schema(SchemaBook& book, const KeyDoc&) { return rule_schema(book, rule_of<T>()); }
};

}  // namespace skerry
