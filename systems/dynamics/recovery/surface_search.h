// Deformation gradients at many nodes of smooth surfaces.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "systems/dynamics/recovery/surface_gradient.h"

namespace skerry {

/// Arguments of surface_gradient.
struct SurfaceSearch {
    MaterialConstants material;
    const SurfaceAround* around;
    Mat3 area_gradient;
    Vec3 traction, start;
};

/// Results of surface_gradient for many nodes. If the law of a material is linear or stable neo-Hookean, up to eight
/// consecutive nodes of this material are solved together in the lanes of a register. The result of a node does not
/// depend on the other nodes.
std::vector<std::optional<Mat3>> surface_gradients(std::span<const SurfaceSearch> searches);

}  // namespace skerry
