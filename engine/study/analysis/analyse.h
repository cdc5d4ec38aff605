// Error bars, orders of convergence and cheapest settings from the runs of a study (docs/methods/study.md).
#pragma once

#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Analyses the runs. The first is the scene as it is, and must be ok. Runs with another status or other times than the
/// first are not evaluated. The name of the scene, the assignments of the cheapest settings and `stopped` are left
/// empty.
StudyResult analyse(std::vector<StudyRun> runs, const StudySettings& settings);

/// Parts of the errors that further runs could reduce or determine more exactly.
struct OpenParts {
    bool step = false;   // a smaller step length
    bool noise = false;  // another perturbation of the start
};
/// Finds the open parts from the runs so far. The first is the scene as it is, and must be ok.
OpenParts open_parts(const std::vector<StudyRun>& runs, const StudySettings& settings);

}  // namespace skerry
