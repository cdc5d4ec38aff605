// Simulates one case of a sweep and writes its result file.
#pragma once

#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct CaseJob {
    int index = 0;
    std::filesystem::path scene;
    CaseHead head;
    std::filesystem::path folder;  // folder of the result file
    bool probes = false;           // also write the series of the scene's probes, as CSV
};

/// Simulates with one thread and writes the case's file last, after all other files. A refused scene and a step that
/// cannot be committed also count as results. Returns an exit code: exit_ok if the file exists, exit_output if it
/// could not be written, exit_signal plus the signal's number if it was stopped, exit_failed for any other failure,
/// which leaves no file.
int run_case(const CaseJob& job);

/// File of the probe series of a case; during the run the series has the unfinished name.
std::filesystem::path series_file(const std::filesystem::path& folder, int index);
std::filesystem::path unfinished_series_file(const std::filesystem::path& folder, int index);

}  // namespace skerry
