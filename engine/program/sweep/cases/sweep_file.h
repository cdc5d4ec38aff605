// Content of a file of cases, which describes a sweep. The members of the structs are the JSON keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/scene/values.h"

namespace skerry {

/// Largest number of cases. Each case has a result file, and a folder can hold this many files. A larger number is
/// probably a typing error.
inline constexpr int most_cases = 1000000;

/// A JSON value of any type. The reader of the scene checks whether the value fits the place to which it is assigned.
struct AnyValue {
    Json json;
};
template <>
struct Value<AnyValue> {
    static void read(const Json& json, const Place&, const KeyDoc&, AnyValue& out) { out.json = json; }
    static Json schema(SchemaBook&, const KeyDoc&) { return Json::object(); }
};

enum class Spacing { linear, log };
template <>
struct EnumNames<Spacing> {
    static constexpr std::array<std::pair<Spacing, std::string_view>, 2> table{{
        {Spacing::linear, "linear"},
        {Spacing::log, "log"},
    }};
};

enum class Distribution { uniform, log_uniform, integer, normal };
template <>
struct EnumNames<Distribution> {
    static constexpr std::array<std::pair<Distribution, std::string_view>, 4> table{{
        {Distribution::uniform, "uniform"},
        {Distribution::log_uniform, "log_uniform"},
        {Distribution::integer, "integer"},
        {Distribution::normal, "normal"},
    }};
};

/// A parameter of a grid. Its values are either the list `values`, or `count` numbers from `from` to `to`, both
/// included.
struct GridEntry {
    std::string name;
    OneOrMore<std::string> set;
    std::vector<AnyValue> values;
    std::optional<Real> from, to;
    int count = 2;
    Spacing spacing = Spacing::linear;
    Place place;
};

/// A parameter with a random value in each case. `from` and `to` are the ends of the distribution; a normal
/// distribution has `mean` and `deviation` instead.
struct DrawnEntry {
    std::string name;
    OneOrMore<std::string> set;
    Distribution distribution = Distribution::uniform;
    std::optional<Real> from, to, mean, deviation;
    Place place;
};

struct RandomEntry {
    std::uint32_t seed = 0;
    int count = 1;
    std::vector<DrawnEntry> parameters;
    Place place;
};

struct SweepFile {
    std::string schema;  // address of the JSON schema, which only text editors use
    std::string name;
    std::string description;
    FilePath scene;
    // Values by their places in the scene, for example materials.rubber.young_modulus. Every case sets these values
    // before its parameters.
    Named<AnyValue> set;
    std::vector<GridEntry> grid;
    std::vector<Named<AnyValue>> list;
    std::optional<RandomEntry> random;
    Place place;
};

/// Reads a file of cases. Throws SceneError if the file is invalid.
SweepFile read_sweep_file(const std::filesystem::path& file);

/// Returns the JSON schema for files of cases.
std::string sweep_schema();

}  // namespace skerry
