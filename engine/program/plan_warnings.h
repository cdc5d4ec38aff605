// Warnings about the values in a scene, found before its first step.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Returns one sentence for each value that was probably given in another unit, or that the run does not use although
/// it differs from the value used.
std::vector<std::string> plan_warnings(const ScenePlan& plan);

}  // namespace skerry
