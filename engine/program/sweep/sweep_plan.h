// Plan of a sweep: the cases, tested with the scene, and the paths of their result files.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/run_case.h"

namespace skerry {

struct SweepPlan {
    SweepFile file;
    Cases cases;
    std::filesystem::path folder;     // folder for the result files
    std::vector<std::string> hashes;  // hash of each case, see CaseHasher

    CaseJob job(int index, bool probes) const;
    CaseFile read(int index) const;
};

/// Reads the file of cases and the scene. Throws SceneError if
/// - the sweep sets a value at a place that does not exist in the scene,
/// - none of the first hundred cases gives a readable scene.
///
/// If only some cases give unreadable scenes, these cases are refused when they run.
SweepPlan plan_sweep(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace skerry
