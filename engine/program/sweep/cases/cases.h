// Cases of a sweep and the values of their parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

struct Parameter {
    std::string name;                 // heading of its column
    std::vector<std::string> places;  // places in the scene that all get its value
    Place place;                      // position in the file of cases
};

struct Cases {
    std::vector<Parameter> parameters;
    std::vector<std::vector<std::optional<Json>>> values;  // by case and parameter; a list may lack some

    int count() const { return static_cast<int>(values.size()); }
};

/// Expands all cases in order; in a grid the last parameter varies first. Throws SceneError for more than a million
/// cases, and if two parameters have the same name or the same place.
Cases cases_of(const SweepFile& sweep);

/// PLACE=VALUE for `skerry run --set`, in the order of execution.
std::vector<std::string> assignments_of(const SweepFile& sweep, const Cases& cases, int index);

/// Returns, for example, "mu=0.3, E=1e5".
std::string case_text(const Cases& cases, int index);

/// Columns that every table has in addition to the parameters. No parameter may have one of these names.
inline constexpr std::string_view case_column = "case", status_column = "status", message_column = "message",
                                  warnings_column = "warnings_text", hash_column = "state_hash";

}  // namespace skerry
