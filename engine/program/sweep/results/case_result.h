// Result of one case, and its file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/program/run_result.h"

namespace skerry {

/// ok: simulated to its end; failed: a step could not be committed; refused: the scene is invalid or cannot be
/// started.
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
    std::string message;                // reason for failure or refusal
    std::vector<std::string> warnings;  // reasons not to rely on the result, one sentence each
    std::string state_hash;             // hash of the final state; empty if the case did not start
    // Numbers for tables, named with their unit, such as seconds_cpu. A refused case has only this one.
    std::vector<std::pair<std::string, double>> figures;
};

/// Content of a case's file besides its result.
struct CaseHead {
    std::string sweep, scene, case_hash;
    Json parameters;                       // parameter values by name
    std::vector<std::string> assignments;  // arguments of `skerry run --set` that run the same case
};

/// Result of a run that ended by itself. `seconds_cpu`: all CPU time that the process spent on it [s].
CaseResult result_of(const RunResult& run, double seconds_cpu);

std::filesystem::path case_file(const std::filesystem::path& folder, int index);
/// Writes the whole file or none. `report`: document of `skerry run --stats`; null without a run.
void write_case(const std::filesystem::path& file, const CaseHead& head, const CaseResult& result, const Json& report);

/// State of a case's file. whole: it has the result of this case; missing: it does not exist; other: it has the result
/// of another case, or is not a result.
enum class CaseFileState { whole, missing, other };
struct CaseFile {
    CaseFileState state = CaseFileState::missing;
    CaseResult result;  // for whole files
    std::string found;  // for other files: a description of the content
};
CaseFile read_case(const std::filesystem::path& file, int index, const std::string& case_hash);

}  // namespace skerry
