// Error bars, orders of convergence and cheapest settings from the runs of a study (docs/methods/study.md).
#pragma once

#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Analyses the runs. The first is the scene as it is, and must be ok. Runs with another status or other times than the
/// first are not evaluated. The name of the scene, the assignments of the cheapest settings and `stopped` are left
/// empty.
StudyResult analyse(std::vector<StudyRun> runs, const StudySettings& settings);

}  // namespace skerry
