// A visual surface that is bound to the nodes of a body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/ragged.h"
#include "skerry/visual.h"
#include "systems/geometry/material_point.h"

namespace skerry {

/// Part of a deformation gradient that a node contributes: F is the sum of x gradient^T over nodes at positions x.
struct GradientTerm {
    Index node;
    Vec3 gradient;  // [1/m]
};

/// Each node of the surface is at p + F d: p is the nearest point of the body, d the offset from p at rest, and F a
/// deformation gradient. Outside of a deformable body p is on a face that faces the same way, if one is near. F is
/// interpolated between nodes of the body, where it is the mean over the tetrahedra around the node, weighted by
/// volume. For a rigid body F comes from one tetrahedron of distant nodes. All node numbers are local to the body.
struct BoundVisual {
    VisualSurface surface;
    VisualFit fit;
    std::vector<MaterialPoint> point;  // nearest point of the body, by node of the surface
    std::vector<Vec3> offset;          // offset from this point at rest, by node of the surface [m]
    // Terms of the deformation gradient, by node of the body. Nodes that no offset depends on have no terms.
    Ragged<GradientTerm> gradient;
};

/// Points of a surface, each with one node and at most one texture point. A node at which texture coordinates jump has
/// several points.
struct VisualPoints {
    std::vector<Index> node, texture_point;         // by point; no_index: no texture point
    std::vector<std::array<Index, 3>> triangles{};  // indices of points
};
VisualPoints split_at_seams(const VisualSurface& surface);

/// Throws SceneError that names `object` if an index of the surface is out of range, a value is not finite, or lists
/// differ in length.
void require_visual(const VisualSurface& surface, const std::string& object);

/// Binds a valid surface to a body at rest. `nodes`: positions at rest [m]. A body without tetrahedra is rigid; `nodes`
/// must then not lie in one plane. `triangles`: surface of a rigid body, at which values are taken.
BoundVisual bind_visual(VisualSurface surface, std::span<const Vec3> nodes,
                        std::span<const std::array<Index, 4>> tetrahedra,
                        std::span<const std::array<Index, 3>> triangles = {});

/// Positions of the nodes of the surface, given those of the body [m]; or velocities, given those of the body [m/s].
std::vector<Vec3> visual_positions(const BoundVisual& visual, std::span<const Vec3> of_body);

/// Values at the nodes of the surface, interpolated from values at the nodes of the body. A node outside of the body
/// has the value of the nearest point.
template <class T>
std::vector<T> visual_values(const BoundVisual& visual, std::span<const T> of_body) {
    std::vector<T> values;
    values.reserve(visual.point.size());
    for (const MaterialPoint& point : visual.point) {
        T value = point.weight[0] * of_body[static_cast<std::size_t>(point.node[0])];
        for (std::size_t k = 1; k < 4; ++k) value += point.weight[k] * of_body[static_cast<std::size_t>(point.node[k])];
        values.push_back(value);
    }
    return values;
}

}  // namespace skerry
