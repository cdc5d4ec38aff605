#include "engine/world/start/start_search.h"

#include <algorithm>
#include <limits>

#include "systems/collision/build_surface.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/inputs/may_collide.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

// Upper limit of the gap that remains between separated bodies, as a fraction of the mean edge length. It matters only
// if the user has set a very large contact distance.
constexpr Real largest_margin = 0.02;

// Rounding errors of positions, as a fraction of the mean edge length.
constexpr Real rounding_of_edges = 1e-9;

/// True if a part of the box lies behind a plane collider, on the side opposite to its normal.
bool reaches_behind(const Aabb& box, const RigidMotion& plane) {
    const Vec3 normal = plane.rotation.col(2);
    const Vec3 lowest = (normal.array() > 0).select(box.lower, box.upper);
    return normal.dot(lowest - plane.position) < 0;
}

}  // namespace

StartSearch::StartSearch(const Model& model, Real now)
    : model_(model), shift_(model.bodies.slot.size(), Vec3::Zero()), solid_(model.bodies.slot.size()) {
    const ColliderTable& colliders = model.colliders;
    for (std::size_t c = 0; c < colliders.slot.size(); ++c) {
        const RigidPose pose = pose_at(colliders.script[c], colliders.keyframe, colliders.initial[c], now);
        collider_.push_back({pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()});
    }
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        Aabb box = empty_box();
        const Range vertices = model.bodies.vertices[b];
        for (Index v = vertices.begin; v < vertices.end; ++v)
            grow(box, model.nodes.position[model.surface.vertices.node[v]]);
        const Real radius = model.bodies.round_radius[b];
        box_.push_back({box.lower.array() - radius, box.upper.array() + radius});
    }
}

std::vector<PairOverlap> StartSearch::find_all() {
    std::vector<PairOverlap> found;
    for (const StartPair& pair : close_pairs(std::vector<char>(box_.size(), 1)))
        if (const std::optional<Overlap> overlap = overlap_of(pair)) found.push_back({pair, *overlap});
    return found;
}

std::vector<StartPair> StartSearch::close_pairs(const std::vector<char>& marked) const {
    std::vector<Aabb> boxes;
    for (std::size_t b = 0; b < box_.size(); ++b) {
        const Aabb own = box(static_cast<Index>(b));
        const Real wider = rounding_of_edges * model_.bodies.mean_edge[b];  // also finds boxes that only touch
        boxes.push_back({own.lower.array() - wider, own.upper.array() + wider});
    }
    const BoxTree tree(boxes);
    std::vector<StartPair> pairs;
    const auto deforms = [&](Index b) { return model_.bodies.kind[b] == BodyKind::deformable; };
    for (std::size_t b = 0; b < boxes.size(); ++b) {
        const auto row = static_cast<Index>(b);
        if (!marked[b]) continue;
        tree.for_each_overlap(boxes[b], [&](Index other) {
            if (other == row || (marked[static_cast<std::size_t>(other)] && other < row)) return;
            if (!deforms(row) && !deforms(other)) return;
            const bool own_first = deforms(row) && (!deforms(other) || row < other);
            const StartPair pair{own_first ? row : other, own_first ? other : row, false};
            if (!is_settled(pair) && collides(pair)) pairs.push_back(pair);
        });
    }
    add_analytic(marked, tree, pairs);
    std::ranges::sort(pairs);
    return pairs;
}

void StartSearch::add_analytic(const std::vector<char>& marked, const BoxTree& tree,
                               std::vector<StartPair>& pairs) const {
    for (std::size_t c = 0; c < collider_.size(); ++c) {
        const ColliderGeometry& geometry = model_.colliders.geometry[c];
        if (geometry.shape == ColliderShape::mesh) continue;
        const auto add = [&](Index b) {
            const StartPair pair{b, static_cast<Index>(c), true};
            if (marked[static_cast<std::size_t>(b)] && model_.bodies.kind[b] == BodyKind::deformable &&
                !is_settled(pair) && collides(pair))
                pairs.push_back(pair);
        };
        if (geometry.shape == ColliderShape::plane)
            tree.for_each([&](const Aabb& box) { return reaches_behind(box, collider_[c]); }, add);
        else
            tree.for_each_overlap(collider_box(geometry, collider_[c]), add);
    }
}

std::optional<Overlap> StartSearch::overlap_of(const StartPair& pair) {
    const std::optional<Overlap> overlap = pair.is_analytic ? overlap_with_collider(pair) : overlap_of_bodies(pair);
    // A depth below the fraction touching_fraction of the margin counts as touching and not as an overlap, as in a step
    // (contact_reach.h).
    if (overlap && overlap->depth > touching_fraction * margin(pair)) return overlap;
    if (pair.is_analytic || model_.bodies.kind[pair.second] != BodyKind::kinematic || has_inside(pair.second))
        return std::nullopt;
    return find_touch_of_open_surface({solid(pair.first), shift(pair.first)}, {solid(pair.second), shift(pair.second)},
                                      rounding(pair));
}

std::optional<RoundSolid> StartSearch::round(Index body) const {
    const Index core = model_.bodies.core_nodes[body];
    if (core == 0 || core == cylinder_core_nodes) return std::nullopt;
    const Vec3* const end = &model_.nodes.position[model_.bodies.nodes[body].begin];
    return RoundSolid{{end[0] + shift(body), end[core - 1] + shift(body)}, core == 2, model_.bodies.round_radius[body]};
}

std::optional<Overlap> StartSearch::overlap_of_bodies(const StartPair& pair) {
    const std::optional<RoundSolid> first = round(pair.first);
    auto second = model_.round_shape(static_cast<std::size_t>(pair.second));
    if (first && second) {
        second->motion.position += shift(pair.second);
        return overlap_of_round(*first, second->geometry, second->motion, rounding(pair));
    }
    // If only one of the two bodies is round, it is represented by the triangles that draw it, which only approximate
    // its exact shape. A small overlap may then be missed. The contacts of the first steps resolve such an overlap.
    return find_overlap({solid(pair.first), shift(pair.first)}, {solid(pair.second), shift(pair.second)},
                        rounding(pair));
}

std::optional<Overlap> StartSearch::overlap_with_collider(const StartPair& pair) {
    const PlacedSolid body{solid(pair.first), shift(pair.first)};
    const ColliderGeometry& geometry = model_.colliders.geometry[pair.second];
    const RigidMotion& motion = collider_[static_cast<std::size_t>(pair.second)];
    if (const std::optional<RoundSolid> found = round(pair.first))
        return overlap_of_round(*found, geometry, motion, rounding(pair));
    if (const auto overlap = find_surface_inside(geometry, motion, body, rounding(pair))) return overlap;
    if (geometry.shape == ColliderShape::plane) return std::nullopt;
    return find_collider_inside(geometry, motion, body, rounding(pair));
}

Vec3 StartSearch::extent(Index body) const {
    const Aabb& own = box_[static_cast<std::size_t>(body)];
    return own.upper - own.lower;
}

Real StartSearch::margin(const StartPair& pair) const {
    const Column<Real>& distance = model_.bodies.contact_distance;
    const Real required_gap = (distance[pair.first] + (pair.is_analytic ? 0 : distance[pair.second])) / 2;
    return std::min(required_gap, largest_margin * mean_edge(pair));
}

Aabb StartSearch::box(Index body) const {
    const Aabb& own = box_[static_cast<std::size_t>(body)];
    return {own.lower + shift(body), own.upper + shift(body)};
}

bool StartSearch::is_settled(const StartPair& pair) const {
    const auto second = static_cast<std::size_t>(pair.second);
    return model_.body_records[static_cast<std::size_t>(pair.first)].settled &&
           (pair.is_analytic ? model_.collider_records[second].settled : model_.body_records[second].settled);
}

bool StartSearch::collides(const StartPair& pair) const {
    return may_collide(model_.bodies, model_.colliders, model_.disabled_pairs.key,
                       pair.is_analytic ? PairKind::collider : PairKind::bodies, pair.first, pair.second);
}

const Solid& StartSearch::solid(Index body) {
    std::unique_ptr<Solid>& found = solid_[static_cast<std::size_t>(body)];
    if (found) return *found;
    const BodyRecord& record = model_.body_records[static_cast<std::size_t>(body)];
    const Range nodes = model_.bodies.nodes[body];
    const std::span<const Vec3> position = model_.nodes.position.span().subspan(static_cast<std::size_t>(nodes.begin),
                                                                                static_cast<std::size_t>(nodes.size()));
    if (record.tetrahedra.empty()) {
        found = std::make_unique<Solid>(solid_of_surface(position, record.surface));
        return *found;
    }
    std::vector<SolidTriangle> surface;
    const bool is_round = model_.bodies.core_nodes[body] > 0;
    if (is_round)
        for (const BoundaryTriangle& triangle : boundary_triangles(record.tetrahedra))
            surface.push_back({triangle.node, triangle.element});
    const Range triangles = is_round ? Range{0, 0} : model_.bodies.triangles[body];
    for (Index t = triangles.begin; t < triangles.end; ++t) {
        const auto& [a, b, c] = model_.surface.triangles.node[t];
        surface.push_back(
            {{a - nodes.begin, b - nodes.begin, c - nodes.begin},
             model_.user_tetrahedron(static_cast<std::size_t>(body), model_.surface.triangles.element[t])});
    }
    found = std::make_unique<Solid>(solid_of_tetrahedra(position, record.tetrahedra, std::move(surface)));
    return *found;
}

Real StartSearch::mean_edge(const StartPair& pair) const {
    const Real own = model_.bodies.mean_edge[pair.first];
    return pair.is_analytic ? own : std::min(own, model_.bodies.mean_edge[pair.second]);
}

Real StartSearch::rounding(const StartPair& pair) const {
    constexpr Real of_positions = 16 * std::numeric_limits<Real>::epsilon();
    const Aabb own = box(pair.first);
    const Real furthest = own.lower.cwiseAbs().cwiseMax(own.upper.cwiseAbs()).maxCoeff();
    return rounding_of_edges * mean_edge(pair) + of_positions * furthest;
}

}  // namespace skerry
