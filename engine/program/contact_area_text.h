// Texts about contact areas that are smaller than the cells of the mesh.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"
#include "skerry/estimate.h"

namespace skerry {

/// Returns one text for each body whose contact areas are too small for its mesh. Bodies are considered only if a probe
/// of the scene measures the stress of the whole body, forces on the body, or forces that it exerts.
std::vector<std::string> contact_area_texts(const ScenePlan& plan, const World& world,
                                            std::span<const ErrorEstimate> errors);

}  // namespace skerry
