// A visual surface that is bound to the nodes of a body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/ragged.h"
#include "skerry/visual.h"
#include "systems/geometry/material_point.h"

namespace skerry {

/// Term of one node in a deformation gradient F, which is the sum of x gradient^T over all terms. x: position of
/// `node`.
struct GradientTerm {
    Index node;
    Vec3 gradient;  // [1/m]
};

/// A visual surface, each node of which follows a material point p of the body. The position of the node is p + F d,
/// with the deformation gradient F at p, and the offset d of the node from p at rest.
///
/// - p is the point of the body nearest to the node at rest. If a node is outside of a deformable body, and boundary
///   triangles that face the same way as the visual surface are near, p is the nearest point of these triangles.
/// - F of a deformable body is interpolated between its nodes. At a node, F is the mean over the adjacent tetrahedra,
///   weighted by volume.
/// - F of a rigid body comes from one tetrahedron of nodes that are far apart.
///
/// All node numbers are local to the body.
struct BoundVisual {
    VisualSurface surface;
    VisualFit fit;
    std::vector<MaterialPoint> point;  // the point p for each node of the surface
    std::vector<Vec3> offset;          // the offset d for each node of the surface [m]; empty: all zero
    // Terms of the deformation gradient, by node of the body. Nodes that no offset depends on have no terms.
    Ragged<GradientTerm> gradient;
};

/// Points of a surface. Each point has one node and at most one texture point. A node at which texture coordinates jump
/// has several points.
struct VisualPoints {
    std::vector<Index> node, texture_point;  // for each point: index of its node, and of its texture point or no_index
    std::vector<std::array<Index, 3>> triangles{};  // indices of points
};
VisualPoints split_at_seams(const VisualSurface& surface);

/// Throws SceneError that names `object` if an index of the surface is out of range, a value is not finite, or lists
/// differ in length.
void require_visual(const VisualSurface& surface, const std::string& object);

/// Binds a valid surface to a body at rest. `nodes`: positions at rest [m]. A body without tetrahedra is rigid; `nodes`
/// must then not lie in one plane. `triangles`: surface of a rigid body, whose nearest points give the surface its
/// positions and values.
BoundVisual bind_visual(VisualSurface surface, std::span<const Vec3> nodes,
                        std::span<const std::array<Index, 4>> tetrahedra,
                        std::span<const std::array<Index, 3>> triangles = {});

/// Positions of the nodes of the surface, given the positions of the nodes of the body [m]. The function is linear, so
/// it also maps velocities [m/s].
std::vector<Vec3> visual_positions(const BoundVisual& visual, std::span<const Vec3> of_body);

/// Values at the nodes of the surface, interpolated from the values `of_body` at the nodes of the body. A node outside
/// of the body has the value of its material point p.
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
