// One case, from its scene to its file.
#pragma once

#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct CaseJob {
    int index = 0;
    std::filesystem::path scene;
    CaseHead head;
    std::filesystem::path folder;  // for its file
    bool probes = false;           // the series of the scene's probes beside it, as CSV
};

/// Simulates with one thread and writes the case's file last, when all else is there. A scene that is refused and a
/// step that cannot be committed are results too. Returns an exit code: exit_ok when the file is there, exit_output
/// where it could not be written, exit_signal and more when it was stopped, exit_failed for anything else, of which
/// nothing is left.
int run_case(const CaseJob& job);

/// The series of a case's probes, and what is there of them while it runs.
std::filesystem::path series_file(const std::filesystem::path& folder, int index);
std::filesystem::path unfinished_series_file(const std::filesystem::path& folder, int index);

}  // namespace skerry
