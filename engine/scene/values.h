// How values of each type are read from JSON and described in the schema.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/options.h"
#include "engine/scene/rules.h"

namespace skerry {

/// A path in a scene file; what is relative starts from the folder of that file.
struct FilePath {
    std::filesystem::path path;
};
/// A rotation in any of its three spellings, as axis times angle.
struct Rotation {
    Vec3 value = Vec3::Zero();  // rad
};
/// Objects by name, in the order of the file.
template <class T>
struct Named {
    std::vector<std::pair<std::string, T>> items;
};
/// Objects by number: keys are whole numbers, written as text, since those of JSON are.
template <class T>
struct ByNumber {
    std::vector<std::pair<int, T>> items;
};
/// One object, or a list of them.
template <class T>
struct OneOrMore {
    std::vector<T> items;
};
/// A 3 x 3 rotation matrix by rows.
struct RotationRows {
    Vec3 value = Vec3::Zero();  // rad, axis times angle
};

Real read_number(const Json& json, const Place& place, const KeyDoc& doc);
Json number_schema(const char* type, const KeyDoc& doc);

template <>
struct Value<bool> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, bool& out);
    static Json schema(SchemaBook&, const KeyDoc&) { return {{"type", "boolean"}}; }
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
    static Json schema(SchemaBook&, const KeyDoc&) { return {{"type", "string"}, {"minLength", 1}}; }
};
template <>
struct Value<FilePath> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, FilePath& out);
    static Json schema(SchemaBook&, const KeyDoc&) { return {{"type", "string"}, {"minLength", 1}}; }
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

void check_count(const Json& json, const Place& place, std::size_t count, const char* of_what);

template <class T, std::size_t N>
struct Value<std::array<T, N>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::array<T, N>& out) {
        check_count(json, place, N, "numbers");
        for (std::size_t i = 0; i < N; ++i) Value<T>::read(json[i], place.item(i), doc, out[i]);
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) {
        return {{"type", "array"}, {"items", Value<T>::schema(book, doc)}, {"minItems", N}, {"maxItems", N}};
    }
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

/// An enum by one of its names.
template <class Enum>
requires std::is_enum_v<Enum>
struct Value<Enum> {
    static std::vector<std::string> names() {
        std::vector<std::string> list;
        for (const auto& [value, name] : EnumNames<Enum>::table) list.emplace_back(name);
        return list;
    }
    static void read(const Json& json, const Place& place, const KeyDoc&, Enum& out) {
        if (!json.is_string()) place.refuse(described(json), "one of " + listed(names()));
        const std::string text = json.get<std::string>();
        const std::optional<Enum> value = from_name<Enum>(text);
        if (!value) place.refuse(in_quotes(text), "one of " + listed(names()), nearest_hint(text, names()));
        out = *value;
    }
    static Json schema(SchemaBook&, const KeyDoc&) { return {{"enum", names()}}; }
};

template <class T>
struct Value<std::optional<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::optional<T>& out) {
        Value<T>::read(json, place, doc, out.emplace());
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return Value<T>::schema(book, doc); }
};
/// Appends: the lists of an included scene come first.
template <class T>
struct Value<std::vector<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, std::vector<T>& out) {
        if (!json.is_array()) place.refuse(described(json), "a list");
        for (std::size_t i = 0; i < json.size(); ++i) Value<T>::read(json[i], place.item(i), doc, out.emplace_back());
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) {
        return {{"type", "array"}, {"items", Value<T>::schema(book, doc)}};
    }
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
        return {{"oneOf", {Value<T>::schema(book, doc), Value<std::vector<T>>::schema(book, doc)}}};
    }
};
template <class T>
struct Value<Named<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Named<T>& out) {
        if (!json.is_object()) place.refuse(described(json), "an object: one key for each name");
        for (const auto& [name, value] : json.items()) {
            const auto same = std::find_if(out.items.begin(), out.items.end(),
                                           [&, &wanted = name](const auto& item) { return item.first == wanted; });
            if (same != out.items.end())
                place.key(name).refuse("the name " + in_quotes(name) + " again", "a name that no included scene has");
            Value<T>::read(value, place.key(name), doc, out.items.emplace_back(name, T{}).second);
        }
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) {
        return {{"type", "object"}, {"additionalProperties", Value<T>::schema(book, doc)}};
    }
};

/// The number that a key is, and nothing else: no sign but minus, no leading zeros, 32 bits.
int read_number_key(const std::string& key, const Place& place);

template <class T>
struct Value<ByNumber<T>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, ByNumber<T>& out) {
        if (!json.is_object()) place.refuse(described(json), "an object: one key for each number");
        for (const auto& [name, value] : json.items()) {
            const int number = read_number_key(name, place.key(name));
            Value<T>::read(value, place.key(name), doc, out.items.emplace_back(number, T{}).second);
        }
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) {
        return {{"type", "object"},
                {"propertyNames", {{"pattern", "^(0|-?[1-9][0-9]{0,9})$"}}},
                {"additionalProperties", Value<T>::schema(book, doc)}};
    }
};

/// Everything else is an object with a rule.
template <class T>
struct Value {
    static void read(const Json& json, const Place& place, const KeyDoc&, T& out) {
        rule_of<T>().read(json, place, out);
    }
    static Json schema(SchemaBook& book, const KeyDoc&) {
        const std::string& name = rule_of<T>().name();
        if (!book.contains(name)) {
            book[name] = nullptr;  // taken, in case the type contains itself
            Json definition = rule_of<T>().schema(book);
            book[name] = std::move(definition);
        }
        return {{"$ref", "#/$defs/" + name}};
    }
};

}  // namespace skerry
