// The cases of a sweep: which values each of them has.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

struct Parameter {
    std::string name;                 // heads its column
    std::vector<std::string> places;  // all get its value
    Place place;                      // in the file of cases
};

struct Cases {
    std::vector<Parameter> parameters;
    std::vector<std::vector<std::optional<Json>>> values;  // by case and parameter; of a list some have none

    int count() const { return static_cast<int>(values.size()); }
};

/// All cases in their order: of a grid the last parameter varies first. Throws SceneError for more than a million, and
/// where two parameters have one name or one place.
Cases cases_of(const SweepFile& sweep);

/// PLACE=VALUE for `skerry run --set`, in the order in which they are carried out.
std::vector<std::string> assignments_of(const SweepFile& sweep, const Cases& cases, int index);

/// "mu=0.3, E=1e5"
std::string case_text(const Cases& cases, int index);

/// Columns of every table beside those of the parameters, which may not be called so.
inline constexpr std::string_view case_column = "case", status_column = "status", message_column = "message",
                                  doubts_column = "doubts_text", hash_column = "state_hash";

}  // namespace skerry
