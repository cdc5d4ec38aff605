// A note about a body that makes the steps of a run very short, by its elements or by the forces on it.
#pragma once

#include <string>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Returns a sentence that names the body that dictates the step length, the cause (its material, badly shaped
/// tetrahedra, or the forces on it) and the remedy. It is empty if the run has few steps, or if steps would not be much
/// longer without this cause.
/// - `steps`: estimated number of steps of the run.
/// - `sample`: longest step that frames and probes allow [s].
std::string stiff_note(const ScenePlan& plan, const World& world, double steps, double sample);

}  // namespace skerry
