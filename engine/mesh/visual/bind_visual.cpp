#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/repair/triangle_tree.h"
#include "engine/mesh/visual/bound_visual.h"
#include "systems/collision/build_surface.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry {

namespace {

// Usual upper limit of the distance of a visual surface from its body, divided by the mean edge length of the boundary
// of the body. The surface may lie outside of the body, because a coarse mesh follows it only roughly.
constexpr Real most_edges_outside = 3;

/// A body at rest, to find the tetrahedron around a point or the point of the boundary nearest to it.
class RestShape {
public:
    /// `boundary`: boundary of the tetrahedra, with at least one triangle.
    RestShape(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
              const SurfaceMesh& boundary)
        : nodes_(nodes),
          tetrahedra_(tetrahedra),
          boundary_(boundary),
          tree_(boundary),
          reach_(most_edges_outside * mesh::mean_edge(boundary)) {
        std::vector<Aabb> boxes;
        for (const std::array<Index, 4>& corners : tetrahedra) {
            boxes.push_back(empty_box());
            for (const Index n : corners) grow(boxes.back(), nodes[static_cast<std::size_t>(n)]);
        }
        boxes_ = BoxTree(boxes);
    }

    /// Material point that a point of the visual surface follows: the point itself if it lies in a tetrahedron,
    /// otherwise the nearest point of a boundary triangle. `normal`: normal of the visual surface at the point.
    MaterialPoint nearest(const Vec3& place, const Vec3& normal) const {
        // Margin for rounding errors of barycentric coordinates. Without it, a point on a common face could be outside
        // of both tetrahedra.
        constexpr Real rounding = 1e-9;
        MaterialPoint inside;
        Real best = -rounding;
        if (!tetrahedra_.empty())
            boxes_.for_each([&](const Aabb& box) { return distance_squared(box, place) <= 0; },
                            [&](Index t) {
                                const MaterialPoint point =
                                    point_of_tetrahedron(nodes_, tetrahedra_[static_cast<std::size_t>(t)], place);
                                const Real least = std::ranges::min(point.weight);
                                if (!(least > best)) return;
                                best = least;
                                inside = point;
                            });
        if (best > -rounding) return inside;
        // A nearby triangle that faces the same way is preferred, so that surfaces on both sides of a gap follow
        // different sides.
        mesh::NearestTriangle found = tree_.nearest_facing(place, normal, reach_ * reach_);
        if (found.triangle == no_index) found = tree_.nearest(place);
        if (found.triangle == no_index) found = {0, {1, 0, 0}, infinity};  // only if squared distances overflow
        const auto& [a, b, c] = boundary_.triangles[static_cast<std::size_t>(found.triangle)];
        return {{a, b, c, a}, {found.weight[0], found.weight[1], found.weight[2], 0}};
    }

private:
    std::span<const Vec3> nodes_;
    std::span<const std::array<Index, 4>> tetrahedra_;
    const SurfaceMesh& boundary_;
    mesh::TriangleTree tree_;
    Real reach_;  // distance up to which a triangle that faces the same way is preferred to the nearest triangle [m]
    BoxTree boxes_;
};

/// Normals of the nodes of a surface, not normalised: sum of the normals of the triangles at the node. The normal of a
/// triangle has the length of twice its area [m^2].
std::vector<Vec3> normals_of_nodes(const VisualSurface& surface) {
    std::vector<Vec3> normals(surface.nodes.size(), Vec3::Zero());
    for (const std::array<Index, 3>& corners : surface.triangles) {
        const auto at = [&](std::size_t k) -> const Vec3& {
            return surface.nodes[static_cast<std::size_t>(corners[k])];
        };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
        for (const Index n : corners) normals[static_cast<std::size_t>(n)] += normal;
    }
    return normals;
}

SurfaceMesh boundary_of(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra) {
    SurfaceMesh surface{.nodes = {nodes.begin(), nodes.end()}, .triangles = {}};
    for (const BoundaryTriangle& triangle : boundary_triangles(tetrahedra)) surface.triangles.push_back(triangle.node);
    return surface;
}

Vec3 position_of(const MaterialPoint& point, std::span<const Vec3> nodes) {
    Vec3 place = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) place += point.weight[k] * nodes[static_cast<std::size_t>(point.node[k])];
    return place;
}

/// Terms of the deformation gradients F at those nodes for which `is_needed` is true. In a tetrahedron of volume V,
/// with corners at x and inward area vectors a of the opposite faces at rest, V F is the sum of x a^T / 3 over the
/// corners.
Ragged<GradientTerm> gradients_of(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                  const std::vector<bool>& is_needed) {
    std::vector<std::vector<GradientTerm>> terms(nodes.size());
    std::vector<Real> volume(nodes.size(), 0);
    for (const std::array<Index, 4>& corners : tetrahedra) {
        const auto at = [&](std::size_t k) -> const Vec3& { return nodes[static_cast<std::size_t>(corners[k])]; };
        const Vec3 u = at(1) - at(0), v = at(2) - at(0), w = at(3) - at(0);
        std::array<Vec3, 4> area{Vec3::Zero(), v.cross(w) / 2, w.cross(u) / 2, u.cross(v) / 2};
        area[0] = -(area[1] + area[2] + area[3]);
        for (const Index corner : corners) {
            const auto n = static_cast<std::size_t>(corner);
            if (!is_needed[n]) continue;
            volume[n] += u.dot(v.cross(w)) / 6;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto known = std::ranges::find(terms[n], corners[k], &GradientTerm::node);
                if (known != terms[n].end())
                    known->gradient += area[k] / 3;
                else
                    terms[n].push_back({corners[k], area[k] / 3});
            }
        }
    }
    Ragged<GradientTerm> gradients;
    gradients.offset.push_back(0);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        for (const GradientTerm& term : terms[n]) gradients.item.push_back({term.node, term.gradient / volume[n]});
        gradients.offset.push_back(static_cast<Index>(gradients.item.size()));
    }
    return gradients;
}

/// Largest extent of a set of points along an axis [m].
Real extent_of(std::span<const Vec3> points) {
    Aabb box = empty_box();
    for (const Vec3& point : points) grow(box, point);
    return points.empty() ? 0 : (box.upper - box.lower).maxCoeff();
}

/// Returns a warning if the fit suggests wrong units or a wrong position of the visual surface, else an empty text.
/// `edge`: mean edge length of the body [m].
std::string warning_of(const BoundVisual& visual, std::span<const Vec3> nodes, Real edge) {
    // Confused units of length (mm, cm, m) change the ratio by a factor of at least 10.
    constexpr Real most_ratio = 5;
    const Real ratio = extent_of(visual.surface.nodes) / extent_of(nodes);
    if (ratio > most_ratio || ratio < 1 / most_ratio)
        return "the visual surface is " + short_text(ratio) +
               " times as large as the body; check the units of both, and its \"scale\"";
    if (visual.fit.farthest > most_edges_outside * edge)
        return "nodes of the visual surface are up to " + short_text(visual.fit.farthest) +
               " m outside of the body, whose surface has a mean edge length of " + short_text(edge) +
               " m; check the position and the units of the surface";
    return {};
}

/// Binds all nodes of the visual surface to a rigid body, each to the nearest point of `triangles`. The offsets rotate
/// with one tetrahedron of nodes that are far apart. If `triangles` is empty, all nodes are bound to this tetrahedron.
void bind_to_solid(BoundVisual& visual, std::span<const Vec3> nodes, std::span<const std::array<Index, 3>> triangles) {
    const std::array<Index, 4> corners = point_of_solid(nodes, nodes[0]).node;
    visual.fit.warning = warning_of(visual, nodes, infinity);
    if (triangles.empty()) {
        for (const Vec3& node : visual.surface.nodes)
            visual.point.push_back(point_of_tetrahedron(nodes, corners, node));
        return;
    }
    const SurfaceMesh surface{.nodes = {nodes.begin(), nodes.end()}, .triangles = {triangles.begin(), triangles.end()}};
    const RestShape shape(nodes, {}, surface);
    std::vector<bool> is_needed(nodes.size(), false);
    for (const Vec3& node : visual.surface.nodes) {
        const MaterialPoint& point = visual.point.emplace_back(shape.nearest(node, Vec3::Zero()));
        visual.offset.push_back(node - position_of(point, nodes));
        for (const Index n : point.node) is_needed[static_cast<std::size_t>(n)] = true;
    }
    const auto at = [&](std::size_t k) -> const Vec3& { return nodes[static_cast<std::size_t>(corners[k])]; };
    std::array<GradientTerm, 4> terms{};  // gradients of the barycentric coordinates at rest [1/m]
    terms[0] = {corners[0], Vec3::Zero()};
    const Vec3 u = at(1) - at(0), v = at(2) - at(0), w = at(3) - at(0);
    const std::array<Vec3, 3> area{v.cross(w), w.cross(u), u.cross(v)};
    for (std::size_t k = 1; k < 4; ++k) {
        terms[k] = {corners[k], area[k - 1] / u.dot(v.cross(w))};
        terms[0].gradient -= terms[k].gradient;
    }
    visual.gradient.offset.push_back(0);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (is_needed[n])
            for (const GradientTerm& term : terms) visual.gradient.item.push_back(term);
        visual.gradient.offset.push_back(static_cast<Index>(visual.gradient.item.size()));
    }
}

}  // namespace

BoundVisual bind_visual(VisualSurface surface, std::span<const Vec3> nodes,
                        std::span<const std::array<Index, 4>> tetrahedra,
                        std::span<const std::array<Index, 3>> triangles) {
    BoundVisual visual{.surface = std::move(surface), .fit = {}, .point = {}, .offset = {}, .gradient = {}};
    visual.point.reserve(visual.surface.nodes.size());
    const SurfaceMesh boundary = boundary_of(nodes, tetrahedra);
    if (boundary.triangles.empty()) {
        bind_to_solid(visual, nodes, triangles);
        return visual;
    }
    const RestShape shape(nodes, tetrahedra, boundary);
    std::vector<bool> is_needed(nodes.size(), false);
    visual.offset.reserve(visual.surface.nodes.size());
    const std::vector<Vec3> normals = normals_of_nodes(visual.surface);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Vec3& node = visual.surface.nodes[i];
        const MaterialPoint& point = visual.point.emplace_back(shape.nearest(node, normals[i]));
        // RestShape::nearest returns the first node twice for a point outside of the body, and only then. A node inside
        // the body gets the offset zero, not a rounding error.
        const bool is_inside = point.node[3] != point.node[0];
        visual.offset.push_back(is_inside ? Vec3::Zero() : Vec3(node - position_of(point, nodes)));
        const Real distance = visual.offset.back().norm();
        if (distance == 0) continue;
        ++visual.fit.outside;
        visual.fit.farthest = std::max(visual.fit.farthest, distance);
        for (const Index n : point.node) is_needed[static_cast<std::size_t>(n)] = true;
    }
    visual.gradient = gradients_of(nodes, tetrahedra, is_needed);
    visual.fit.warning = warning_of(visual, nodes, mesh::mean_edge(boundary));
    return visual;
}

VisualPoints split_at_seams(const VisualSurface& surface) {
    VisualPoints points;
    std::map<std::array<Index, 2>, Index> point_of_corner;  // index of the point for each pair (node, texture point)
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        std::array<Index, 3>& corners = points.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const Index node = surface.triangles[t][k];
            const Index texture = surface.texture_corners.empty() ? no_index : surface.texture_corners[t][k];
            const auto [place, is_new] =
                point_of_corner.try_emplace({node, texture}, static_cast<Index>(points.node.size()));
            corners[k] = place->second;
            if (!is_new) continue;
            points.node.push_back(node);
            points.texture_point.push_back(texture);
        }
    }
    return points;
}

std::vector<Vec3> visual_positions(const BoundVisual& visual, std::span<const Vec3> of_body) {
    std::vector<Vec3> positions = visual_values(visual, of_body);
    if (visual.gradient.item.empty()) return positions;
    std::vector<Mat3> gradient(of_body.size(), Mat3::Zero());
    for (std::size_t n = 0; n < gradient.size(); ++n)
        for (const GradientTerm& term : visual.gradient[n])
            gradient[n] += of_body[static_cast<std::size_t>(term.node)] * term.gradient.transpose();
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const MaterialPoint& point = visual.point[i];
        if (visual.offset[i].isZero(0)) continue;
        for (std::size_t k = 0; k < 3; ++k)
            positions[i] += point.weight[k] * (gradient[static_cast<std::size_t>(point.node[k])] * visual.offset[i]);
    }
    return positions;
}

}  // namespace skerry
