#include "systems/collision/collider_crossings.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "systems/collision/awake_candidates.h"
#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/face_contact.h"
#include "systems/collision/colliders/time_of_touch.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/winding_number.h"

namespace skerry {

namespace {

class ColliderCrossings {
public:
    ColliderCrossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs, Index p,
                      Column<ContactRow>& found)
        : inputs_(inputs),
          motion_(motion),
          pair_{pairs.key[p], pairs.kind[p], pairs.first[p], pairs.second[p]},
          geometry_(inputs.collider.geometry[pair_.second]),
          collider_motion_(inputs.collider.motion[pair_.second]),
          travel_(pairs.travel[p]),
          candidates_(pairs.candidates[p].span()),
          asleep_until_(pairs.asleep_until[p].span()),
          found_(found) {}

    std::uint64_t run(Range range, Real travel_bound) {
        return count_tested(asleep_until_, range, travel_bound,
                            [&](Index c) { return test(candidates_[c], asleep_until_[c] - travel_); });
    }

private:
    using Kind = TouchingFeature::Kind;

    /// `least`: lower bound of the distance, or of the motion up to which only nodes can touch [m].
    bool test(const Candidate& candidate, Real least) {
        std::array<Index, 3> node{};
        const TouchingFeature feature = feature_of(candidate, node);
        // All points of a rim are tested by the candidate of the point that follows the face.
        const bool has_rims = collider_point_follows(geometry_.shape, 0);
        const bool is_another =
            feature.kind == Kind::face && has_rims && !collider_point_follows(geometry_.shape, feature.of_collider);
        if (is_another || !can_move(node, feature.nodes())) return false;
        const Real approach = greatest_approach(collider_motion_, motion_.h, feature);
        if (!(approach > slow_fraction * least)) return false;
        if (feature.kind == Kind::face) {
            const FaceContact now = face_contact(geometry_, feature.of_collider, local(feature));
            if (!(approach > slow_fraction * std::max(now.nearest, now.distance))) return false;
        }
        if (the_end_tells(geometry_, feature) && !(approach > distance_to_plane(feature.position[0]))) return false;
        const std::optional<Touch> touch = first_touch(geometry_, collider_motion_, motion_.h, feature);
        if (!touch || (touch->within && !is_outside(inputs_, pair_.first, world(touch->point)))) return true;
        add(candidate, feature, node, *touch);
        return true;
    }

    TouchingFeature feature_of(const Candidate& candidate, std::array<Index, 3>& node) const {
        TouchingFeature feature;
        feature.of_collider = second_local(candidate.feature);
        if (is_edge_edge(candidate.feature)) {
            const auto& end = inputs_.surface.edges.node[candidate.first];
            node = {end[0], end[1], no_index};
            feature.kind = Kind::edge;
            feature.of_collider /= contacts_of_edge;
        } else if (is_face_collider(candidate.feature)) {
            node = inputs_.surface.triangles.node[candidate.first];
            feature.kind = Kind::face;
            feature.of_collider = first_local(candidate.feature);
        } else {
            node = {inputs_.surface.vertices.node[candidate.first], no_index, no_index};
            feature.kind = Kind::node;
        }
        if (feature.kind != Kind::face)
            feature.kept = kept_of_radii(pair_scale(inputs_, pair_.kind, pair_.first, pair_.second));
        for (std::size_t i = 0; i < feature.nodes(); ++i) {
            feature.position[i] = inputs_.position[node[i]];
            feature.displacement[i] = motion_.of(node[i]);
        }
        return feature;
    }

    Real distance_to_plane(const Vec3& point) const {
        return collider_motion_.rotation.col(2).dot(point - collider_motion_.position);
    }
    Vec3 world(const Vec3& point) const { return collider_motion_.position + collider_motion_.rotation * point; }
    LocalFace local(const TouchingFeature& feature) const {
        LocalFace face;
        for (std::size_t i = 0; i < 3; ++i)
            face[i] = collider_motion_.rotation.transpose() * (feature.position[i] - collider_motion_.position);
        return face;
    }
    bool can_move(const std::array<Index, 3>& node, std::size_t count) const {
        return std::any_of(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(count),
                           [&](Index n) { return inputs_.inverse_mass[n] > 0; });
    }

    void add(const Candidate& candidate, const TouchingFeature& feature, const std::array<Index, 3>& node,
             const Touch& touch) {
        // place and normal of the touch at the start of the step
        const Vec3 normal = collider_motion_.rotation * touch.normal, point = world(touch.point),
                   arm = point - collider_motion_.position;
        Stencil stencil{{}, {}};
        std::size_t count = 0;
        Real along = 0;  // [m]
        for (std::size_t i = 0; i < feature.nodes(); ++i) {
            if (touch.weight[i] == 0) continue;
            stencil.node[count] = node[i];
            stencil.weight[count++] = touch.weight[i];
            along += touch.weight[i] * normal.dot(feature.position[i] - point);
        }
        std::fill(stencil.node.begin() + static_cast<std::ptrdiff_t>(count), stencil.node.end(), stencil.node[0]);
        Candidate numbered = candidate;
        if (feature.kind == Kind::edge) numbered.feature += static_cast<std::uint64_t>(crossing_of_edge);
        const ContactKind kind = feature.kind == Kind::edge   ? ContactKind::edge_collider
                                 : feature.kind == Kind::face ? ContactKind::face_collider
                                                              : ContactKind::point_collider;
        const PairScale scale = pair_scale(inputs_, pair_.kind, pair_.first, pair_.second);
        ContactRow row =
            contact_row(inputs_, pair_, numbered, kind, stencil, point, normal, std::max(along, scale.radii),
                        scale.contact_distance, pair_surface(inputs_, pair_.kind, pair_.first, pair_.second));
        row.surface_velocity = collider_motion_.velocity + collider_motion_.angular_velocity.cross(arm);
        found_.push_back(row);
    }

    const CollisionInputs& inputs_;
    const StepMotion& motion_;
    const ContactPair pair_;
    const ColliderGeometry& geometry_;
    const RigidMotion& collider_motion_;
    const Real travel_;
    std::span<const Candidate> candidates_;
    std::span<const Real> asleep_until_;
    Column<ContactRow>& found_;
};

}  // namespace

std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found) {
    return ColliderCrossings(inputs, motion, pairs, p, found).run(range, travel_bound);
}

}  // namespace skerry
