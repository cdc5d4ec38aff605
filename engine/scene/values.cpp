#include "engine/scene/values.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace skerry {

namespace {

std::string all_digits(Real number) {
    return Json(number).dump();
}

std::string expected_number(const KeyDoc& doc, const std::string& kind) {
    std::string text = kind;
    const auto add = [&text](const char* words, const std::optional<Real>& bound) {
        if (bound)
            text +=
                (text.find(" of ") == std::string::npos && text.find(" above ") == std::string::npos ? " " : " and ") +
                std::string(words) + " " +
                (*bound == std::floor(*bound) && std::abs(*bound) < 1e15
                     ? std::to_string(static_cast<long long>(*bound))
                     : all_digits(*bound));
    };
    add("of at least", doc.limits.at_least);
    add("above", doc.limits.above);
    add("of at most", doc.limits.at_most);
    add("below", doc.limits.below);
    return text + (doc.unit.empty() ? "" : " [" + std::string(doc.unit) + "]");
}

void check_limits(Real number, const Json& json, const Place& place, const KeyDoc& doc, const std::string& kind) {
    const Limits& limits = doc.limits;
    const bool inside = std::isfinite(number) && (!limits.at_least || number >= *limits.at_least) &&
                        (!limits.above || number > *limits.above) && (!limits.at_most || number <= *limits.at_most) &&
                        (!limits.below || number < *limits.below);
    if (!inside) place.refuse(json.dump(), expected_number(doc, kind));
}

/// Largest accepted entry of |M M^T - I| for a rotation matrix M (I: identity). It is not zero because files contain
/// few digits.
constexpr Real rotation_tolerance = 1e-6;

/// A rotation that a scene file gives as an object with axis and angle.
struct AxisAngle {
    Vec3 axis = Vec3::UnitZ();
    std::optional<Real> degrees, radians;
};

}  // namespace

template <>
const Rule<AxisAngle>& rule_of<AxisAngle>() {
    static const Rule<AxisAngle> rule =
        Rule<AxisAngle>("axis_and_angle", "A rotation about an axis.")
            .key("axis", &AxisAngle::axis,
                 {.meaning = "direction of the axis, as a vector of any nonzero length", .required = true})
            .key("degrees", &AxisAngle::degrees, {.meaning = "angle of the rotation", .unit = "degrees"})
            .key("radians", &AxisAngle::radians, {.meaning = "angle of the rotation", .unit = "rad"})
            .exactly_one({"degrees", "radians"})
            .check([](const Place& place, const AxisAngle& r) {
                if (!(r.axis.norm() > 0))
                    place.key("axis").refuse("a vector of length 0", "a vector of nonzero length");
            });
    return rule;
}

Real read_number(const Json& json, const Place& place, const KeyDoc& doc) {
    if (!json.is_number()) place.refuse(described(json), expected_number(doc, "a number"));
    const Real number = json.get<Real>();
    check_limits(number, json, place, doc, "a number");
    return number;
}

Json number_schema(const char* type, const KeyDoc& doc) {
    Json schema = object_of({{"type", type}});
    if (doc.limits.at_least) schema["minimum"] = *doc.limits.at_least;
    if (doc.limits.above) schema["exclusiveMinimum"] = *doc.limits.above;
    if (doc.limits.at_most) schema["maximum"] = *doc.limits.at_most;
    if (doc.limits.below) schema["exclusiveMaximum"] = *doc.limits.below;
    return schema;
}

void check_count(const Json& json, const Place& place, std::size_t count, const char* of_what) {
    if (!json.is_array() || json.size() != count)
        place.refuse(described(json), "a list of " + std::to_string(count) + " " + of_what);
}

void Value<bool>::read(const Json& json, const Place& place, const KeyDoc&, bool& out) {
    if (!json.is_boolean()) place.refuse(described(json), "true or false");
    out = json.get<bool>();
}

namespace {

/// Reads a whole number that must lie between `least` and `largest` and within the limits of the key.
Real read_whole(const Json& json, const Place& place, const KeyDoc& doc, Real least, Real largest) {
    const std::string kind = "a whole number";
    if (!json.is_number()) place.refuse(described(json), expected_number(doc, kind));
    const Real number = json.get<Real>();
    if (number != std::floor(number) || number < least || number > largest)
        place.refuse(described(json), expected_number(doc, kind));
    check_limits(number, json, place, doc, kind);
    return number;
}

}  // namespace

void Value<int>::read(const Json& json, const Place& place, const KeyDoc& doc, int& out) {
    constexpr Real largest = 2147483647;
    out = static_cast<int>(read_whole(json, place, doc, -largest, largest));
}

void Value<std::uint32_t>::read(const Json& json, const Place& place, const KeyDoc& doc, std::uint32_t& out) {
    constexpr Real largest = 4294967295;
    out = static_cast<std::uint32_t>(read_whole(json, place, doc, 0, largest));
}

std::size_t read_name(const Json& json, const Place& place, const std::vector<std::string>& names,
                      std::string_view (*hint_for_removed)(std::string_view)) {
    if (!json.is_string()) place.refuse(described(json), "one of " + listed(names));
    const auto& text = json.get_ref<const std::string&>();
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) {
        const std::string hint(hint_for_removed(text));
        place.refuse(in_quotes(text), "one of " + listed(names), hint.empty() ? nearest_hint(text, names) : hint);
    }
    return static_cast<std::size_t>(found - names.begin());
}

void read_items(const Json& json, const Place& place, FunctionRef<void(const Json&, const Place&)> item) {
    if (!json.is_array()) place.refuse(described(json), "a list");
    for (std::size_t i = 0; i < json.size(); ++i) item(json[i], place.item(i));
}

void read_named(const Json& json, const Place& place, FunctionRef<bool(const std::string&)> has,
                FunctionRef<void(const std::string&, const Json&, const Place&)> item) {
    if (!json.is_object()) place.refuse(described(json), "an object {NAME: VALUE, ...}");
    for (const auto& [name, value] : json.items()) {
        if (has(name))
            place.key(name).refuse("the name " + in_quotes(name) + ", which an included scene already uses",
                                   "a name that no included scene uses");
        item(name, value, place.key(name));
    }
}

Json text_schema() {
    return object_of({{"type", "string"}, {"minLength", 1}});
}

Json boolean_schema() {
    return object_of({{"type", "boolean"}});
}

Json enum_schema(const std::vector<std::string>& names) {
    return object_of({{"enum", names}});
}

Json list_schema(Json items) {
    return object_of({{"type", "array"}, {"items", std::move(items)}});
}

Json list_schema(Json items, std::size_t count) {
    return object_of({{"type", "array"}, {"items", std::move(items)}, {"minItems", count}, {"maxItems", count}});
}

Json named_schema(Json value) {
    return object_of({{"type", "object"}, {"additionalProperties", std::move(value)}});
}

Json either_schema(Json one, Json other) {
    return object_of({{"oneOf", Json::array({std::move(one), std::move(other)})}});
}

Json rule_schema(SchemaBook& book, const RuleTable& rule) {
    const std::string& name = rule.name();
    if (!book.contains(name)) {
        book[name] = nullptr;  // placeholder that ends the recursion if the type contains itself
        Json definition = rule.schema(book);
        book[name] = std::move(definition);
    }
    return object_of({{"$ref", "#/$defs/" + name}});
}

void Value<std::string>::read(const Json& json, const Place& place, const KeyDoc& doc, std::string& out) {
    if (!json.is_string() || json.get_ref<const std::string&>().empty())
        place.refuse(described(json), "a text that is not empty: " + std::string(doc.meaning));
    out = json.get<std::string>();
}

void Value<FilePath>::read(const Json& json, const Place& place, const KeyDoc& doc, FilePath& out) {
    std::string text;
    Value<std::string>::read(json, place, doc, text);
    out.path = place.folder() / text;  // an absolute path remains unchanged
    std::error_code error;
    if (!std::filesystem::exists(out.path, error))
        place.refuse("the path of a missing file, " + in_quotes(out.path.string()),
                     "the path of an existing file, relative to the folder of the file that contains it");
    if (std::filesystem::is_directory(out.path, error))
        place.refuse("the path of a folder, " + in_quotes(out.path.string()), "the path of a file");
}

void Value<RotationRows>::read(const Json& json, const Place& place, const KeyDoc&, RotationRows& out) {
    check_count(json, place, 3, "rows");
    Mat3 matrix;
    for (Index row = 0; row < 3; ++row) {
        const auto place_in_list = static_cast<std::size_t>(row);
        Vec3 numbers = Vec3::Zero();
        Value<Vec3>::read(json[place_in_list], place.item(place_in_list), {}, numbers);
        matrix.row(row) = numbers.transpose();
    }
    const Mat3 defect = matrix * matrix.transpose() - Mat3::Identity();
    if (!(defect.cwiseAbs().maxCoeff() <= rotation_tolerance))
        place.refuse("rows that are not orthonormal: the largest error is " + all_digits(defect.cwiseAbs().maxCoeff()),
                     "a rotation matrix with errors of at most 1e-6");
    if (matrix.determinant() < 0) place.refuse("a reflection (determinant -1)", "a rotation matrix (determinant 1)");
    const Eigen::AngleAxis<Real> turn(Eigen::Quaternion<Real>(matrix).normalized());
    out.value = turn.angle() * turn.axis();
}

Json Value<RotationRows>::schema(SchemaBook& book, const KeyDoc&) {
    return list_schema(Value<Vec3>::schema(book, {}), 3);
}

void Value<TimeTable>::read(const Json& json, const Place& place, const KeyDoc& doc, TimeTable& out) {
    if (!json.is_array()) {
        out = read_number(json, place, doc);
        return;
    }
    out.keys.clear();
    for (std::size_t k = 0; k < json.size(); ++k) {
        const Place at = place.item(k);
        if (!json[k].is_array() || json[k].size() != 2) at.refuse(described(json[k]), "a pair [time, value]");
        const TimeKey key{read_number(json[k][0], at.item(0), {.meaning = {}, .unit = "s"}),
                          read_number(json[k][1], at.item(1), doc)};
        if (!out.keys.empty() && !(key.time > out.keys.back().time))
            at.item(0).refuse(all_digits(key.time) + " s",
                              "a time after that of the previous pair, " + all_digits(out.keys.back().time) + " s");
        out.keys.push_back(key);
    }
    if (out.keys.empty()) place.refuse("an empty list", "a number, or a list of at least one pair [time, value]");
}

Json Value<TimeTable>::schema(SchemaBook&, const KeyDoc& doc) {
    const Json pair =
        object_of({{"type", "array"},
                   {"prefixItems", Json::array({number_schema("number", {}), number_schema("number", doc)})},
                   {"minItems", 2},
                   {"maxItems", 2}});
    Json pairs = list_schema(pair);
    pairs["minItems"] = 1;
    return either_schema(number_schema("number", doc), std::move(pairs));
}

void Value<Rotation>::read(const Json& json, const Place& place, const KeyDoc& doc, Rotation& out) {
    const std::string spellings = R"({"axis": [x, y, z], "degrees": angle} or three rows of a rotation matrix)";
    if (json.is_array()) {
        if (!json.empty() && std::ranges::all_of(json, [](const Json& item) { return item.is_number(); }))
            place.refuse(
                described(json), spellings,
                json.size() == 4
                    ? "write the quaternion cos(a/2), sin(a/2) (x, y, z) as the angle a about the axis (x, y, z)"
                    : "write the rotation as one axis and one angle; several angles are ambiguous, because their order "
                      "matters");
        RotationRows rows;
        Value<RotationRows>::read(json, place, doc, rows);
        out.value = rows.value;
        return;
    }
    if (!json.is_object()) place.refuse(described(json), spellings);
    AxisAngle turn;
    Value<AxisAngle>::read(json, place, doc, turn);
    const Real angle = turn.radians ? *turn.radians : *turn.degrees * std::numbers::pi / 180;
    out.value = angle * turn.axis.normalized();
}

Json Value<Rotation>::schema(SchemaBook& book, const KeyDoc& doc) {
    return either_schema(Value<AxisAngle>::schema(book, doc), Value<RotationRows>::schema(book, doc));
}

}  // namespace skerry
