// Plan of a sweep before it runs: its cases, checked against the scene, and the paths of their files.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/run_case.h"

namespace skerry {

struct SweepPlan {
    SweepFile file;
    Cases cases;
    std::filesystem::path folder;     // folder of the results
    std::vector<std::string> hashes;  // one hash per case

    CaseJob job(int index, bool probes) const;
    CaseFile read(int index) const;
};

/// Reads cases and scene. Throws SceneError for places that do not exist in the scene, and if none of the first
/// hundred cases gives a readable scene. A single case with an unreadable scene is a result.
SweepPlan plan_sweep(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace skerry
