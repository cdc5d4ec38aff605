#include <algorithm>
#include <array>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_crossings.h"

namespace skerry {

namespace {

class ColliderCrossings : PairCrossings {
public:
    using PairCrossings::PairCrossings;

    /// Tests one candidate for a crossing in this step. Returns true if a full test was needed. `least`: smallest
    /// relative motion of body and collider with which the feature can touch the collider between its nodes, which are
    /// candidates of their own [m].
    bool test(const Candidate& candidate, Real least) {
        std::array<Index, 3> node{};
        const TouchingFeature feature = feature_of_candidate(candidate, node);
        // A rim has five points (collider_point). Only the candidate of point 0 is tested: this point is the furthest
        // behind the plane of the face, so its test covers the whole rim.
        const bool has_rims = is_moving_rim_point(geometry_.shape, 0);
        const bool is_another =
            feature.kind == Kind::face && has_rims && !is_moving_rim_point(geometry_.shape, feature.part_or_point);
        if (is_another || !can_move(std::span(node).first(feature.nodes()))) return false;
        const Real approach = greatest_approach(pose_, motion.h, feature);
        if (!(approach > slow_fraction * least)) return false;
        if (feature.kind == Kind::face) {
            const auto& x = feature.position;
            const FaceContact now = face_contact(geometry_, feature.part_or_point,
                                                 {to_local(pose_, x[0]), to_local(pose_, x[1]), to_local(pose_, x[2])});
            if (!(approach > slow_fraction * std::max(now.nearest, now.distance))) return false;
        }
        // For a plane collider: height of the first node above the plane [m].
        const Real height = pose_.rotation.col(2).dot(feature.position[0] - pose_.position);
        if (end_position_suffices(geometry_, feature) && !(approach > height)) return false;
        const std::optional<Touch> touch = first_touch(geometry_, pose_, motion.h, feature);
        if (!touch || (touch->within && !is_outside(inputs, first, to_world(pose_, touch->point)))) return true;
        add(candidate, feature, node, *touch);
        return true;
    }

private:
    using Kind = TouchingFeature::Kind;

    TouchingFeature feature_of_candidate(const Candidate& candidate, std::array<Index, 3>& node) const {
        const Index local = second_local(candidate.feature);
        if (is_face_collider(candidate.feature)) {
            node = inputs.surface.triangles.node[candidate.first];
            return feature_of(Kind::face, node, first_local(candidate.feature), {});
        }
        if (is_edge_edge(candidate.feature)) {
            const auto& end = inputs.surface.edges.node[candidate.first];
            node = {end[0], end[1], no_index};
            return feature_of(Kind::edge, node, local / contacts_of_edge, threshold_of_radii(scale));
        }
        node = {inputs.surface.vertices.node[candidate.first], no_index, no_index};
        return feature_of(Kind::node, node, local, threshold_of_radii(scale));
    }

    void add(const Candidate& candidate, const TouchingFeature& feature, const std::array<Index, 3>& node,
             const Touch& touch) {
        // Normal and contact point of the collider, in the world. Both are fixed to the collider, and its pose at the
        // start of the step is used.
        const Vec3 normal = pose_.rotation * touch.normal, point = to_world(pose_, touch.point);
        Stencil stencil{{}, {}};
        std::size_t count = 0;
        // Height of the point of the feature that touches, above the contact point of the collider, measured along the
        // normal at the start of the step [m].
        Real along = 0;
        for (std::size_t i = 0; i < feature.nodes(); ++i) {
            if (touch.weight[i] == 0) continue;
            stencil.node[count] = node[i];
            stencil.weight[count++] = touch.weight[i];
            along += touch.weight[i] * normal.dot(feature.position[i] - point);
        }
        std::fill(stencil.node.begin() + static_cast<std::ptrdiff_t>(count), stencil.node.end(), stencil.node[0]);
        const ContactKind contact_kind = feature.kind == Kind::edge   ? ContactKind::edge_collider
                                         : feature.kind == Kind::face ? ContactKind::face_collider
                                                                      : ContactKind::point_collider;
        found.push_back(contact_row(
            *this, candidate.feature + static_cast<std::uint64_t>(feature.kind == Kind::edge ? crossing_of_edge : 0),
            contact_kind, stencil,
            {point, normal, std::max(along, scale.radii), scale.contact_distance, velocity_at(pose_, point)}));
    }

    const ColliderGeometry& geometry_ = inputs.collider.geometry[second];
    const RigidMotion& pose_ = inputs.collider.motion[second];
};

}  // namespace

std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found) {
    ColliderCrossings crossings(inputs, motion, pairs, p, found);
    return count_tested(pairs.asleep_until[p].span(), range, travel_bound, [&](Index c) {
        return crossings.test(pairs.candidates[p][c], pairs.asleep_until[p][c] - pairs.travel[p]);
    });
}

}  // namespace skerry
