// Deformation gradient at a node of a smooth surface, from the surface around the node and its traction.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/material_table.h"
#include "components/types.h"

namespace skerry {

/// Surface triangles around a node, summed up.
struct SurfaceAround {
    Vec3 area = Vec3::Zero();       // outward area vector of the node: a third of that of its triangles [m^2]
    Vec3 normal = Vec3::Zero();     // unit vector along `area`
    Mat3 projector = Mat3::Zero();  // sum of area times the projector onto the plane of the triangle [m^2]
    Mat3 stretch = Mat3::Zero();    // sum of area times the deformation gradient within the plane [m^2]
    bool smooth = false;            // false if the surface has an edge or corner at the node
};

/// `triangles`: the triangles around the node. `rest`, `position`: positions of all nodes at rest and now [m].
SurfaceAround surface_around(std::span<const std::array<Index, 3>> surface, std::span<const Index> triangles,
                             std::span<const Vec3> rest, std::span<const Vec3> position);

/// Deformation gradient F with P(F) N = traction for the outward normal N, and otherwise the least squared difference
/// from the deformation gradients within the triangles (docs/methods/elasticity.md 7.9). `start`: first guess of F N.
/// The surface must be smooth. Empty if Newton's method finds no F.
std::optional<Mat3> surface_gradient(const MaterialConstants& material, const SurfaceAround& around,
                                     const Vec3& traction, const Vec3& start);

}  // namespace skerry
