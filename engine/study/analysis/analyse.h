// Error bars, orders of convergence and cheapest settings from the runs of a study (docs/methods/study.md).
#pragma once

#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Analyses the runs. The first must be the run of the unchanged scene, with the status `ok`. Runs with another status,
/// other columns or another number of rows are not evaluated. In the result, the name of the scene, the assignments of
/// the cheapest settings and `stopped` stay empty.
StudyResult analyse(std::vector<StudyRun> runs, const StudySettings& settings);

/// Parts of the errors that further runs could reduce or determine more exactly.
struct OpenParts {
    bool step = false;   // true if a run with a smaller step length would help
    bool noise = false;  // true if a run with another perturbation of the start would help
};
/// Finds the open parts from the runs so far. The first must be the run of the unchanged scene, with the status `ok`.
OpenParts open_parts(const std::vector<StudyRun>& runs, const StudySettings& settings);

}  // namespace skerry
