// What came of one case, and its file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/program/run_result.h"

namespace skerry {

/// ok: simulated to its end; failed: a step could not be committed; refused: the scene is not understood or cannot
/// begin.
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
    std::string message;              // why it failed or was refused
    std::vector<std::string> doubts;  // why not to rely on it
    std::string state_hash;           // of its end; empty where it did not begin
    // One number each for tables, by name with its unit, such as seconds_cpu; of a refused one none but that.
    std::vector<std::pair<std::string, double>> figures;
};

/// What stands in the file of a case beside its result.
struct CaseHead {
    std::string sweep, scene, case_hash;
    Json parameters;                       // values by name
    std::vector<std::string> assignments;  // for `skerry run --set`, which runs the same case
};

/// The figures of a run that ended by itself. `seconds_cpu`: of all the process did for it.
CaseResult result_of(const RunResult& run, double seconds_cpu);

std::filesystem::path case_file(const std::filesystem::path& folder, int index);
/// The whole file, or none. `report`: the document of `skerry run --stats`; null where there was no run.
void write_case(const std::filesystem::path& file, const CaseHead& head, const CaseResult& result, const Json& report);

/// What the file of a case is. whole: it has the result of this case; missing: there is none; other: it has that of
/// another case, or is no result.
enum class CaseFileState { whole, missing, other };
struct CaseFile {
    CaseFileState state = CaseFileState::missing;
    CaseResult result;  // of a whole one
    std::string found;  // of another one, what it is
};
CaseFile read_case(const std::filesystem::path& file, int index, const std::string& case_hash);

}  // namespace skerry
