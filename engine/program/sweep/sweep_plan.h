// A sweep before it runs: its cases, whether the scene knows what they set, and where their files are.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/run_case.h"

namespace skerry {

struct SweepPlan {
    SweepFile file;
    Cases cases;
    std::filesystem::path folder;     // of the results
    std::vector<std::string> hashes;  // by case

    CaseJob job(int index, bool probes) const;
    CaseFile read(int index) const;
};

/// Reads cases and scene. Throws SceneError for places that the scene has not, and where none of the cases (of many:
/// of the first hundred) is a scene that can be read: one that cannot is a result.
SweepPlan plan_sweep(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace skerry
