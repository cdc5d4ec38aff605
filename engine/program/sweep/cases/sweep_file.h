// Content of a file of cases, key by key.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/scene/values.h"

namespace skerry {

/// Each case has a file. A folder can hold this many; a larger count is more likely a typing mistake.
inline constexpr int most_cases = 1000000;

/// Any JSON value. The scene checks later whether it fits its place.
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

/// A parameter of a grid: a list of values, or a range from one number to another.
struct GridEntry {
    std::string name;
    OneOrMore<std::string> set;
    std::vector<AnyValue> values;
    std::optional<Real> from, to;
    int count = 2;
    Spacing spacing = Spacing::linear;
    Place place;
};

/// A parameter with random values.
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
    std::string schema;  // used by editors only
    std::string name;
    std::string description;
    FilePath scene;
    Named<AnyValue> set;  // assignments of every case
    std::vector<GridEntry> grid;
    std::vector<Named<AnyValue>> list;
    std::optional<RandomEntry> random;
    Place place;
};

/// Reads a file of cases. Throws SceneError.
SweepFile read_sweep_file(const std::filesystem::path& file);

/// The JSON schema of files of cases.
std::string sweep_schema();

}  // namespace skerry
