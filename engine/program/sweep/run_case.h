// Simulates one case of a sweep and writes its result file.
#pragma once

#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct CaseJob {
    int index = 0;
    std::filesystem::path scene;
    CaseHead head;
    std::filesystem::path folder;  // folder of the result file
    bool probes = false;           // also write the time series of the scene's probes as CSV
};

/// Simulates a case with one thread. The result file is written last, after all other files of the case. A refused
/// scene and a simulation that fails are results, too. Returns
/// - exit_ok if the result file exists,
/// - exit_output if a file could not be written,
/// - exit_signal plus the number of the signal if a signal stopped the run,
/// - exit_failed after any other failure, which leaves no result file.
int run_case(const CaseJob& job);

/// Final and temporary path of the file for the time series of the probes of a case. The file has the temporary path
/// until the run has ended.
std::filesystem::path series_file(const std::filesystem::path& folder, int index);
std::filesystem::path unfinished_series_file(const std::filesystem::path& folder, int index);

}  // namespace skerry
