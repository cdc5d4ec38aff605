// Cases of a sweep and the values of their parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

struct Parameter {
    std::string name;  // heading of the parameter's column in tables
    // places in the scene that the parameter sets, e.g. materials.rubber.young_modulus
    std::vector<std::string> places;
    Place place;  // location of the parameter in the file of cases, for error messages
};

struct Cases {
    std::vector<Parameter> parameters;
    // Values, indexed by case and then by parameter. A value is empty if a case of a list does not set the parameter.
    std::vector<std::vector<std::optional<Json>>> values;

    int count() const { return static_cast<int>(values.size()); }
};

/// Returns all cases in order. In a grid the last parameter varies fastest. Throws SceneError if there are more than a
/// million cases, or if two parameters have the same name or set the same place.
Cases cases_of(const SweepFile& sweep);

/// Returns the assignments PLACE=VALUE of a case in the order in which they are applied, for `skerry run --set`.
std::vector<std::string> assignments_of(const SweepFile& sweep, const Cases& cases, int index);

/// Describes the parameter values of a case, for example "mu=0.3, E=1e5".
std::string case_text(const Cases& cases, int index);

/// Headings of the columns that a table may have besides the columns of parameters. No parameter may have one of these
/// names.
inline constexpr std::string_view case_column = "case", status_column = "status", message_column = "message",
                                  warnings_column = "warnings_text", hash_column = "state_hash";

}  // namespace skerry
