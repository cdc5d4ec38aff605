// Result of one case, and the file that stores it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/program/run_result.h"

namespace skerry {

/// Outcome of a case.
/// - ok: the case was simulated to its end, and the results can be trusted.
/// - failed: the simulation ended early, or its results cannot be trusted (WorldReport::distrust).
/// - refused: the scene is invalid or cannot be started.
enum class CaseStatus { ok, failed, refused };
template <>
struct EnumNames<CaseStatus> {
    static constexpr std::array<std::pair<CaseStatus, std::string_view>, 3> table{{
        {CaseStatus::ok, "ok"},
        {CaseStatus::failed, "failed"},
        {CaseStatus::refused, "refused"},
    }};
};

struct CaseResult {
    int index = 0;
    CaseStatus status = CaseStatus::ok;
    std::string message;                // reason why the case failed or was refused
    std::vector<std::string> warnings;  // reasons not to rely on the result, one sentence each
    std::string state_hash;             // hash of the final state; empty if the case was refused
    // Numbers for tables, by name. If a number has a unit, its name ends with the unit, for example kinetic_J. A
    // refused case has the number seconds_cpu only.
    std::vector<std::pair<std::string, double>> figures;
};

/// Data in the result file of a case that identify the case.
struct CaseHead {
    // name of the sweep, path of the scene, and hash of the case (see CaseHasher)
    std::string sweep, scene, case_hash;
    Json parameters;  // values of the parameters, by name
    // Assignments with which `skerry run --set` runs the same case.
    std::vector<std::string> assignments;
};

/// Returns the result of a run that was not stopped by a signal. `seconds_cpu` is the CPU time of the process [s].
CaseResult result_of(const RunResult& run, double seconds_cpu);

std::filesystem::path case_file(const std::filesystem::path& folder, int index);
/// Writes the result file of a case, completely or not at all. `report` is the document of `skerry run --stats`, or
/// null if the case was refused.
void write_case(const std::filesystem::path& file, const CaseHead& head, const CaseResult& result, const Json& report);

/// State of the result file of a case.
/// - whole: the file has the result of this case.
/// - missing: the file does not exist.
/// - other: the file has the result of another case or of an earlier version of the scene, or is not a result file.
enum class CaseFileState { whole, missing, other };
struct CaseFile {
    CaseFileState state = CaseFileState::missing;
    CaseResult result;  // result of the case, if the state is `whole`
    std::string found;  // description of the file's content, if the state is `other`
};
CaseFile read_case(const std::filesystem::path& file, int index, const std::string& case_hash);

}  // namespace skerry
