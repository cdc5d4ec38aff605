#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "systems/collision/cylinders/cylinder_touches.h"
#include "systems/collision/cylinders/rigid_cylinder.h"
#include "systems/collision/cylinders/shape_facets.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_crossings.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

// Lowest values of the `number` (feature_of_touch) of a crossing, above the numbers that find_cylinder_contacts uses:
// - crossing_of_triangle: eight numbers for a triangle: three corners, three edges, two rims of the cylinder
// - crossing_of_shape: one number for each contact point with another shape at the end of the step
// - crossing_during_step: first contact with another shape during the step
constexpr Index crossing_of_triangle = 48, crossing_of_shape = CylinderTouches::capacity,
                crossing_during_step = touches_of_shape - 1;
static_assert(crossing_of_triangle + 8 <= touches_of_triangle && 2 * CylinderTouches::capacity <= touches_of_shape);

// If the motion is at most this fraction of half the thickness of the thinner shape, a test at the end of the step
// suffices: to pass completely through the other one, a shape must move much further.
constexpr Real thin_fraction = 0.5;

class CylinderCrossings : PairCrossings {
public:
    CylinderCrossings(const PairCrossings& pair, std::span<const ContactRow> known)
        : PairCrossings(pair), known_(known) {}

    bool test(const Candidate& candidate) {
        if (kind == PairKind::collider)
            return against_shape(candidate, {inputs.collider.geometry[second],
                                             inputs.collider.motion[second],
                                             second_local(candidate.feature),
                                             {}});
        const Index core = inputs.body.core_nodes[second], begin = inputs.body.nodes[second].begin;
        if (core == 0) return against_triangle(candidate);
        if (core != cylinder_core_nodes) return against_core(candidate, {begin, begin + core - 1, begin});
        const RigidCylinder other = cylinder_in_step(inputs, motion, second);
        return against_shape(candidate, {other.geometry, other.motion, 0,
                                         stencil_of_point({cylinder_.middle, begin, begin, begin}, {1, 0, 0})});
    }

private:
    using Kind = TouchingFeature::Kind;

    bool against_triangle(const Candidate& candidate) {
        const Index t = candidate.second;
        const TriangleTable& table = inputs.surface.triangles;
        const auto& node = table.node[t];
        if (!any_moves(node)) return false;
        const TouchingFeature face = feature_of(Kind::face, node, 0, threshold(0));
        const LocalFace local{cylinder_.local(face.position[0]), cylinder_.local(face.position[1]),
                              cylinder_.local(face.position[2])};
        if (!may_meet(face, distance_bound(cylinder_.geometry, local))) return false;
        for (Index k = 0; k < 3; ++k) {
            const Index next = (k + 1) % 3;
            if (table.owned_vertices[t] >> k & 1)
                test_feature(candidate, crossing_of_triangle + k, Kind::node, {node[k], node[k], node[k]});
            if (table.owned_edges[t] >> k & 1)
                test_feature(candidate, crossing_of_triangle + 3 + k, Kind::edge, {node[k], node[next], node[k]});
        }
        for (Index rim = 0; rim < 2; ++rim)
            test_feature(candidate, crossing_of_triangle + 6 + rim, Kind::face, node, point_of_rim(rim));
        return true;
    }

    /// Tests a feature of the other body for a crossing. `radius`: radius if the body is a sphere or capsule, whose
    /// feature is its core (centre or axis); 0 for a surface of triangles [m]. Returns true if a full test was needed.
    bool test_feature(const Candidate& candidate, Index number, Kind feature_kind, const std::array<Index, 3>& node,
                      Index part_or_point = 0, Real radius = 0) {
        const TouchingFeature feature = feature_of(feature_kind, node, part_or_point, threshold(radius));
        if (!may_meet(feature, nearest(feature).distance)) return false;
        const std::optional<Hit> hit = first_hit(feature);
        if (!hit || (hit->touch.within && !is_outside(inputs, second, cylinder_.world(hit->touch.point)))) return true;
        add_hit(candidate, number, stencil_of_point({cylinder_.middle, node[0], node[1], node[2]}, hit->touch.weight),
                feature, *hit, Vec3::Zero());
        return true;
    }

    /// Tests the cylinder against a sphere or a capsule. `node`: nodes at the ends of the capsule's axis, or twice the
    /// node at the centre of the sphere.
    bool against_core(const Candidate& candidate, const std::array<Index, 3>& node) {
        return any_moves(node) &&
               test_feature(candidate, crossing_of_shape, node[0] == node[1] ? Kind::node : Kind::edge, node, 0,
                            inputs.body.round_radius[second]);
    }

    /// A shape near the cylinder, and the motion of the shape in the step. `stencil`: nodes and weights of the contact
    /// if the shape is a body; no value for a collider.
    struct OtherShape {
        const ColliderGeometry& geometry;
        const RigidMotion& motion;
        Index part;
        std::optional<Stencil> stencil;
    };

    bool against_shape(const Candidate& candidate, const OtherShape& other) {
        if (!(inputs.inverse_mass[cylinder_.middle] > 0) && !other.stencil) return false;
        touches_.clear();
        const Real bound = distance_bound_at(0, other);
        if (other.geometry.shape == ColliderShape::plane) return against_plane(candidate, other.motion, bound);
        const Real furthest = motion.h * (other.motion.angular_velocity.norm() * collider_radius(other.geometry) +
                                          other.motion.velocity.norm()) +
                              max_cylinder_path();
        if (!(furthest > slow_fraction * bound)) return false;
        find_touches(0, other, furthest + scale.shell);
        if (!(furthest > slow_fraction * distance_bound_at(0, other))) return false;
        if (!any_overlap() && add_end(candidate, other)) return true;
        if (furthest > thin_fraction * std::min(half_thickness(cylinder_.geometry), half_thickness(other.geometry)))
            add_during_step(candidate, other);
        return true;
    }

    /// Adds contacts and returns true if the shapes overlap at any contact point at the end of the step. All contact
    /// points nearer than the shell distance (PairScale::shell) are added: with the overlapping ones only, the cylinder
    /// would rotate about these and overlap at the others in the next attempt.
    bool add_end(const Candidate& candidate, const OtherShape& other) {
        find_touches(1, other, scale.shell);
        if (!any_overlap()) return false;
        for (const CylinderTouch& touch : touches_)
            add_touch(candidate, crossing_of_shape + touch.number, other, touch, 1, touch.distance);
        return true;
    }

    /// Adds the first contact during the step between the cylinder and the other shape, which is approximated by its
    /// facets.
    void add_during_step(const Candidate& candidate, const OtherShape& other) {
        std::optional<Hit> first_found;
        TouchingFeature first_feature{};
        const RigidMotion end = at(other.motion, 1);
        ShapeFacets(other.geometry, other.part).for_each([&](const Facet& facet) {
            TouchingFeature feature{
                .kind = facet.kind, .part_or_point = 0, .position = {}, .threshold = threshold(facet.radius)};
            for (std::size_t i = 0; i < feature.nodes(); ++i) {
                feature.position[i] = to_world(other.motion, facet.at[i]);
                feature.displacement[i] = to_world(end, facet.at[i]) - feature.position[i];
            }
            for (Index rim = 0; rim < (facet.kind == Kind::face ? 2 : 1); ++rim) {
                feature.part_or_point = point_of_rim(rim);
                if (!may_meet(feature, nearest(feature).distance)) continue;
                const std::optional<Hit> hit = first_hit(feature);
                if (!hit || hit->touch.within || (first_found && first_found->time <= hit->time)) continue;
                first_found = hit;
                first_feature = feature;
            }
        });
        if (!first_found) return;
        const Vec3 point = touched_point(first_feature, *first_found);
        add_hit(candidate, crossing_during_step, other.stencil.value_or(stencil_of_middle()), first_feature,
                *first_found, other.stencil ? Vec3(Vec3::Zero()) : velocity_at(other.motion, point));
    }

    struct Hit {
        Touch touch;
        Real time;  // time of the contact as a fraction of the step
    };
    std::optional<Hit> first_hit(const TouchingFeature& feature) const {
        Real time = 0;
        const std::optional<Touch> touch = first_touch(cylinder_.geometry, cylinder_.motion, motion.h, feature, &time);
        return touch ? std::optional(Hit{*touch, time}) : std::nullopt;
    }
    /// Position, at the start of the step, of the point of the feature that touches the cylinder at the time hit.time
    /// [m].
    static Vec3 touched_point(const TouchingFeature& feature, const Hit& hit) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < feature.nodes(); ++i) sum += hit.touch.weight[i] * feature.position[i];
        return sum;
    }
    void add_hit(const Candidate& candidate, Index number, const Stencil& stencil, const TouchingFeature& feature,
                 const Hit& hit, const Vec3& surface_velocity) {
        const Vec3 normal = -(rotation_at(hit.time) * hit.touch.normal),
                   arm = cylinder_.motion.rotation * hit.touch.point;
        const Real along =
            normal.dot(cylinder_.motion.position + arm - touched_point(feature, hit)) - feature.threshold.distance;
        add_crossing(candidate, number, stencil, arm, normal, along, surface_velocity);
    }

    void add_touch(const Candidate& candidate, Index number, const OtherShape& other, const CylinderTouch& touch,
                   Real time, Real end_distance) {
        const RigidMotion own = at(cylinder_.motion, time);
        const Vec3 normal = own.rotation * touch.normal, on_other = to_world(own, touch.on_other),
                   arm = cylinder_.motion.rotation * (touch.on_other + touch.distance * touch.normal),
                   at_start = to_world(other.motion, to_local(at(other.motion, time), on_other));
        const Real along = normal.dot(cylinder_.motion.position + arm - at_start);
        add_crossing(candidate, number, other.stencil.value_or(stencil_of_middle()), arm, normal, along,
                     other.stencil ? Vec3(Vec3::Zero()) : velocity_at(other.motion, at_start), end_distance);
    }

    void find_touches(Real time, const OtherShape& other, Real near) {
        touches_.clear();
        touch_shape(cylinder_.geometry, other.geometry, other.part, relative_pose(time, other), near, touches_);
    }
    Real distance_bound_at(Real time, const OtherShape& other) const {
        return shape_distance_bound(cylinder_.geometry, other.geometry, other.part, relative_pose(time, other),
                                    touches_);
    }
    RigidMotion relative_pose(Real time, const OtherShape& other) const {
        const RigidMotion own = at(cylinder_.motion, time), other_pose = at(other.motion, time);
        const Mat3 back = own.rotation.transpose();
        return {back * (other_pose.position - own.position), back * other_pose.rotation, Vec3::Zero(), Vec3::Zero()};
    }
    bool any_overlap() const {
        return std::any_of(touches_.begin(), touches_.end(), [](const CylinderTouch& t) { return t.distance < 0; });
    }

    /// Tests the cylinder against a plane. The positions at the end of the step suffice for this test, because no shape
    /// can move around a plane.
    bool against_plane(const Candidate& candidate, const RigidMotion& plane, Real distance) {
        if (!(max_cylinder_path() + motion.h * plane.velocity.norm() +
                  motion.h * plane.angular_velocity.norm() *
                      ((cylinder_.motion.position - plane.position).norm() + max_cylinder_path() + ball_radius()) >
              distance) ||
            distance < 0)
            return false;
        const RigidMotion end = at(cylinder_.motion, 1), plane_end = at(plane, 1);
        const Vec3 normal = plane_end.rotation.col(2), local = end.rotation.transpose() * normal;
        Vec3 deepest = -cylinder_.geometry.size[1] * (local[2] > 0 ? 1 : -1) * Vec3::UnitZ();
        const Real radial = local.head<2>().norm();
        if (radial > 0) deepest.head<2>() = -cylinder_.geometry.size[0] / radial * local.head<2>();
        if (!(normal.dot(end.position + end.rotation * deepest - plane_end.position) < 0)) return true;
        const Vec3 arm = cylinder_.motion.rotation * deepest;
        const Real along = normal.dot(cylinder_.motion.position + arm - plane.position);
        add_crossing(candidate, crossing_of_shape, stencil_of_middle(), arm, normal, along,
                     velocity_at(plane, cylinder_.motion.position + arm));
        return true;
    }

    Touch nearest(const TouchingFeature& feature) const {
        std::array<Vec3, 3> local;
        for (std::size_t i = 0; i < feature.nodes(); ++i) local[i] = cylinder_.local(feature.position[i]);
        return nearest_touch(cylinder_.geometry, feature, local);
    }
    bool may_meet(const TouchingFeature& feature, Real distance) const {
        return greatest_approach(cylinder_.motion, motion.h, feature) > slow_fraction * distance;
    }

    /// Rotation matrix of the cylinder at `time`, a fraction of the step.
    Mat3 rotation_at(Real time) const {
        return rotation_matrix(time * motion.h * cylinder_.motion.angular_velocity) * cylinder_.motion.rotation;
    }
    /// Appends a crossing. `arm`: vector from the centre of the cylinder to the contact point at the start of the step
    /// [m]. `along` and `end_distance`: distances between the surfaces at the contact point at the start and at the end
    /// of the step [m].
    void add_crossing(const Candidate& candidate, Index number, const Stencil& stencil, const Vec3& arm,
                      const Vec3& normal, Real along, const Vec3& surface_velocity, Real end_distance = 0) {
        const auto row_at = [&](Real distance) {
            const Vec3 point = cylinder_.motion.position + arm - distance * normal;
            return contact_row(*this, feature_of_touch(*this, candidate.feature, number),
                               kind == PairKind::collider ? ContactKind::point_collider : ContactKind::point_triangle,
                               stencil, {point, normal, distance, scale.shell, surface_velocity});
        };
        // `along` compares positions at the start of the step, but measures along the normal at the time of contact. If
        // the shapes have rotated by more than a right angle in between, `along` can be negative although nothing
        // overlapped at the start.
        ContactRow row = row_at(std::max(along, Real(0)));
        // A contact prevents the crossing only if its point moves on a straight path. If the cylinder rotates, the
        // surfaces may overlap at the end although an earlier attempt at the step already had this contact. Its
        // distance is then reduced by this overlap, so that it pushes further.
        if (end_distance < 0) {
            const auto before = std::ranges::lower_bound(known_, row.key, std::less{}, &ContactRow::key);
            if (before != known_.end() && before->key == row.key)
                row = row_at(std::max(std::min(row.distance, before->distance) + end_distance, Real(0)));
        }
        found.push_back(row);
    }

    /// Distances at which the test counts a feature as crossing. `radius`: radius of the sphere or capsule whose core
    /// (centre or axis) is the feature, else 0 [m].
    ///
    /// With a shell distance, the gap must fall below a tenth of it (contact_slack), so that a feature that a contact
    /// stops at the shell distance does not count. Otherwise first_touch() takes a tenth of the distance at the start
    /// of the step.
    ContactThreshold threshold(Real radius) const {
        return {radius, scale.shell > 0 ? contact_slack * scale.shell : infinity};
    }
    bool any_moves(const std::array<Index, 3>& node) const {
        return can_move(std::array{cylinder_.middle, node[0], node[1], node[2]});
    }
    Stencil stencil_of_middle() const { return stencil_of_point({cylinder_.middle, no_index, no_index, no_index}, {}); }
    /// Number of the first point of a rim (collider_point). The position of this point depends on the face.
    static Index point_of_rim(Index rim) { return rim * collider_point_count(ColliderShape::cylinder) / 2; }
    /// Pose of a shape at `time`, a fraction of the step.
    RigidMotion at(const RigidMotion& pose, Real time) const {
        const Real passed = time * motion.h;
        return {pose.position + passed * pose.velocity, rotation_matrix(passed * pose.angular_velocity) * pose.rotation,
                Vec3::Zero(), Vec3::Zero()};
    }
    /// Half of the smallest thickness of a shape [m].
    static Real half_thickness(const ColliderGeometry& geometry) {
        const Vec3& size = geometry.size;
        switch (geometry.shape) {
            case ColliderShape::box:
                return size.minCoeff();
            case ColliderShape::cylinder:
                return std::min(size[0], size[1]);
            case ColliderShape::bucket:
                return size[2] / 2;
            case ColliderShape::sphere:
            case ColliderShape::capsule:
            case ColliderShape::plane:
            case ColliderShape::mesh:
                break;
        }
        return size[0];
    }
    Real ball_radius() const { return std::hypot(cylinder_.geometry.size[0], cylinder_.geometry.size[1]); }
    Real max_cylinder_path() const {
        return motion.h * (cylinder_.motion.velocity.norm() + cylinder_.motion.angular_velocity.norm() * ball_radius());
    }

    const RigidCylinder cylinder_ = cylinder_in_step(inputs, motion, first);
    std::span<const ContactRow> known_;  // crossings that earlier attempts at this step have found, in key order
    CylinderTouches touches_;
};

}  // namespace

std::uint64_t find_cylinder_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, std::span<const ContactRow> known,
                                      Column<ContactRow>& found) {
    CylinderCrossings crossings({inputs, motion, pairs, p, found}, known);
    return count_tested(pairs.asleep_until[p].span(), range, travel_bound,
                        [&](Index c) { return crossings.test(pairs.candidates[p][c]); });
}

}  // namespace skerry
