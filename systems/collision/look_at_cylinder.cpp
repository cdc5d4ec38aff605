#include "systems/collision/look_at_cylinder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/cylinders/nearest_bound.h"
#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_look.h"

namespace skerry {

namespace {

// The travel of the nodes of the rims is more than this fraction of the motion of the points between them.
constexpr Real of_rim_nodes = 0.95;

// An edge counts as parallel to the axis if the sine of their angle is below this. It touches the side along a stretch,
// or hardly at all.
constexpr Real parallel_sine = 1e-3;

// Slopes of the distance along an edge below this count as zero.
constexpr Real straight_slope = 1e-7;

// Numbers of the touches with a triangle: three corners, eight places of each edge, nine of each rim.
constexpr Index number_of_edges = 3, places_of_edge = 8, number_of_faces = number_of_edges + 3 * places_of_edge;
static_assert(number_of_faces + 2 * RimPoints::most_of_rim <= touches_of_triangle);

constexpr Real seam_fraction = 1e-9;  // of an edge: places this near to a seam are over one or both of its faces

class CylinderContacts : PairLook {
public:
    CylinderContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                     Index p, Column<ContactRow>& found)
        : PairLook(inputs, settings, h, pairs, p, found),
          state_(pairs.state[p]),
          of_(inputs, pairs, p),
          cylinder_(cylinder_at_start(inputs, of_.cylinder)) {}

    Real run(Range range) {
        for_each_awake(range, [&](Index c) { wake(c); });
        return nearest_;
    }

private:
    void wake(Index c) {
        if (prepare()) held_apart_ = is_held_apart(settings_, state_, scale_);
        const Candidate& candidate = candidates_[c];
        if (of_.kind == PairKind::collider)
            against_collider(c, candidate);
        else if (inputs_.body.core_nodes[of_.other] == 0)
            against_triangle(c, candidate);
        else
            against_core(c, candidate);
    }

    /// `distance`: lower bound of the distance between the surfaces [m]. Returns true if the candidate matters in this
    /// step.
    bool note(Index c, Real distance) {
        nearest_ = std::min(nearest_, distance);
        asleep_until_[c] = travel_base_ + (distance > 0 ? of_rim_nodes : 1) * distance - scale_.shell;
        return distance <= near();
    }
    /// True if a bound shows that the candidate does not matter in this step. Else its touches give a sharper bound.
    bool is_far(Index c, Real bound) { return bound > near() && !note(c, bound); }
    Real near() const { return near_ - scale_.radii; }
    bool is_reached(Real distance, Real speed) const { return within_reach(distance + scale_.radii, speed); }

    void against_triangle(Index c, const Candidate& candidate) {
        const Index t = candidate.second;
        const TriangleTable& table = inputs_.surface.triangles;
        const auto& node = table.node[t];
        const LocalFace face{local(node[0]), local(node[1]), local(node[2])};
        if (!note(c, distance_bound(cylinder_.geometry, face))) return;
        for (std::size_t k = 0; k < 3; ++k)
            if (table.owned_vertices[t] >> k & 1) corner(candidate, k, face[k]);
        for (std::size_t k = 0; k < 3; ++k)
            if (table.owned_edges[t] >> k & 1) edge(candidate, k, face[k], face[(k + 1) % 3]);
        rims(c, candidate, face);
    }

    void corner(const Candidate& candidate, std::size_t k, const Vec3& at) {
        const SurfacePoint on = local_distance(cylinder_.geometry, at, 0);
        if (!(on.distance <= near())) return;
        const Index vertex = inputs_.surface.triangles.vertex[candidate.second][k];
        const CylinderPlace place = place_of(on.normal);
        const Vec3 normal = -(cylinder_.motion.rotation * on.normal);
        bool holds = place == CylinderPlace::end;
        if (place == CylinderPlace::side)
            holds = vertex_holds_axis(inputs_.surface, inputs_.position, vertex,
                                      cylinder_.world({0, 0, at[2]}) - cylinder_.world(at),
                                      cylinder_.motion.rotation.col(2), scale_);
        if (place == CylinderPlace::rim)
            holds = vertex_holds_place(inputs_.surface, inputs_.position, vertex,
                                       std::max(std::abs(on.distance), scale_.edge) * normal, scale_);
        std::array<Real, 3> weight{};
        weight[k] = 1;
        if (holds) add_touch(candidate, static_cast<Index>(k), weight, normal, on.distance);
    }

    void edge(const Candidate& candidate, std::size_t k, const Vec3& a, const Vec3& b) {
        if (!(edge_distance(cylinder_.geometry, 0, a, b) <= near())) return;
        const EdgeContact contact = edge_contact(cylinder_.geometry, 0, a, b);
        const Vec3 along = b - a;
        const bool parallel = along.head<2>().norm() <= parallel_sine * along.norm();
        for (std::size_t i = 0; i < contact.count; ++i) {
            const EdgePoint& touch = contact.point[i];
            if (!(touch.on.distance <= near())) continue;
            const Vec3 normal = -(cylinder_.motion.rotation * touch.on.normal);
            // A cylinder that rolls or slides over a flat place is held by its faces alone: an edge ahead would be a
            // bump.
            const CylinderPlace place = place_of(touch.on.normal);
            const bool straight_on = std::abs(touch.on.normal.dot(along)) <= straight_slope * along.norm();
            const bool nearly_flat =
                place == CylinderPlace::end || (place == CylinderPlace::side && !parallel && straight_on);
            if (!edge_faces(inputs_.surface, inputs_.position, inputs_.surface.triangles.edge[candidate.second][k],
                            normal, nearly_flat))
                continue;
            std::array<Real, 3> weight{};
            weight[k] = 1 - touch.s;
            weight[(k + 1) % 3] = touch.s;
            add_touch(candidate, number_of_edges + places_of_edge * static_cast<Index>(k) + touch.number, weight,
                      normal, touch.on.distance);
        }
    }

    void rims(Index c, const Candidate& candidate, const LocalFace& face) {
        const Vec3 area = (face[1] - face[0]).cross(face[2] - face[0]);
        const Real length = area.norm();
        if (!(length > 0)) return;
        const Vec3 normal = area / length;
        for (const RimPoints::Point& point : RimPoints(cylinder_.geometry, normal)) {
            const Real height = normal.dot(point.at - face[0]);
            if (!(height <= near() && -height <= scale_.face_depth)) continue;
            const PointTriangle closest = closest_point_on_triangle(point.at, face[0], face[1], face[2]);
            const Vec3 beside = closest.nearest + height * normal - point.at;
            if (closest.region != TriangleRegion::face && !(beside.norm() <= seam_fraction * scale_.edge)) continue;
            if (height < 0 && !is_truly_behind(c, point.at, -height)) continue;
            add_touch(candidate, number_of_faces + point.number, closest.weight, cylinder_.motion.rotation * normal,
                      height);
        }
    }

    /// True if the point has come through this face, as for bodies and colliders. In pairs held apart nothing is behind
    /// a face.
    bool is_truly_behind(Index c, const Vec3& point, Real depth) const {
        return !held_apart_ && depth <= scale_.face_depth && is_nearest(c, depth, [&](Index i) {
            const auto& node = inputs_.surface.triangles.node[candidates_[i].second];
            return closest_point_on_triangle(point, local(node[0]), local(node[1]), local(node[2])).distance_squared;
        }) && !is_outside(inputs_, of_.other, cylinder_.world(point));
    }

    void add_touch(const Candidate& candidate, Index number, const std::array<Real, 3>& weight, const Vec3& normal,
                   Real distance) {
        const auto& node = inputs_.surface.triangles.node[candidate.second];
        Vec3 point = Vec3::Zero();
        Real speed = 0;
        for (std::size_t k = 0; k < 3; ++k) point += weight[k] * inputs_.position[node[k]];
        const Vec3 velocity = cylinder_.velocity_at(point);
        for (const Index n : node) speed = std::max(speed, (inputs_.velocity[n] - velocity).norm());
        if (is_reached(distance, speed))
            put(candidate, number, stencil_of_cylinder(cylinder_.middle, node, weight), point, normal, distance);
    }

    void put(const Candidate& candidate, Index number, const Stencil& stencil, const Vec3& point, const Vec3& normal,
             Real distance, const Vec3& surface_velocity = Vec3::Zero()) {
        add(contact_row(inputs_, of_,
                        {candidate.feature, number, stencil, point, normal, distance, scale_.shell, surface_velocity},
                        surface_));
    }

    /// Tests a sphere, a capsule or another cylinder. The point of the candidate may be the middle of the other
    /// partner.
    void against_core(Index c, const Candidate& candidate) {
        const Index core = inputs_.body.core_nodes[of_.other], first = inputs_.body.nodes[of_.other].begin;
        const Real radius = inputs_.body.round_radius[of_.other];
        touches_.clear();
        if (core == cylinder_core_nodes) {
            const RigidCylinder other = cylinder_at_start(inputs_, of_.other);
            const RigidMotion place = seen_from_cylinder(other.motion);
            if (is_far(c, shape_distance_bound(cylinder_.geometry, other.geometry, 0, place, touches_))) return;
            touch_shape(cylinder_.geometry, other.geometry, 0, place, near(), touches_);
            note(c, shape_distance_bound(cylinder_.geometry, other.geometry, 0, place, touches_));
            for (const CylinderTouch& touch : touches_) {
                const Vec3 point = cylinder_.world(touch.on_other);
                if (is_reached(touch.distance, (cylinder_.velocity_at(point) - other.velocity_at(point)).norm()))
                    put(candidate, touch.number,
                        stencil_of_cylinder(cylinder_.middle, {first, first, first}, {1, 0, 0}), point,
                        cylinder_.motion.rotation * touch.normal, touch.distance);
            }
            return;
        }
        const Vec3 a = local(first), b = local(first + core - 1);
        if (core == 1) {
            if (note(c, local_distance(cylinder_.geometry, a, 0).distance - radius))
                touch_ball(cylinder_.geometry, a, radius, near(), touches_);
        } else if (note(c, edge_distance(cylinder_.geometry, 0, a, b) - radius)) {
            touch_capsule(cylinder_.geometry, a, b, radius, near(), touches_);
        }
        for (const CylinderTouch& touch : touches_) {
            const Vec3 point = cylinder_.world(touch.on_other), velocity = cylinder_.velocity_at(point);
            const Real speed = std::max((inputs_.velocity[first] - velocity).norm(),
                                        (inputs_.velocity[first + core - 1] - velocity).norm());
            if (is_reached(touch.distance, speed))
                put(candidate, touch.number,
                    stencil_of_cylinder(cylinder_.middle, {first, first + core - 1, first},
                                        {touch.weight[0], touch.weight[1], 0}),
                    point, cylinder_.motion.rotation * touch.normal, touch.distance);
        }
    }

    void against_collider(Index c, const Candidate& candidate) {
        const ColliderGeometry& geometry = inputs_.collider.geometry[of_.other];
        const RigidMotion& motion = inputs_.collider.motion[of_.other];
        const RigidMotion place = seen_from_cylinder(motion);
        const Index part = second_local(candidate.feature);
        touches_.clear();
        if (is_far(c, shape_distance_bound(cylinder_.geometry, geometry, part, place, touches_))) return;
        touch_shape(cylinder_.geometry, geometry, part, place, near(), touches_);
        note(c, shape_distance_bound(cylinder_.geometry, geometry, part, place, touches_));
        for (const CylinderTouch& touch : touches_) {
            const Vec3 point = cylinder_.world(touch.on_other),
                       velocity = motion.velocity + motion.angular_velocity.cross(point - motion.position);
            if (is_reached(touch.distance, (cylinder_.velocity_at(point) - velocity).norm()))
                put(candidate, touch.number, stencil_of_cylinder(cylinder_.middle, {}, {}), point,
                    cylinder_.motion.rotation * touch.normal, touch.distance, velocity);
        }
    }

    RigidMotion seen_from_cylinder(const RigidMotion& motion) const {
        return {cylinder_.local(motion.position), cylinder_.motion.rotation.transpose() * motion.rotation, Vec3::Zero(),
                Vec3::Zero()};
    }
    Vec3 local(Index node) const { return cylinder_.local(inputs_.position[node]); }

    const PairState state_;
    const CylinderPair of_;
    const RigidCylinder cylinder_;
    CylinderTouches touches_;
    bool held_apart_ = false;
    Real nearest_ = std::numeric_limits<Real>::infinity();
};

}  // namespace

Real look_at_cylinder(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                      PairTable& pairs, Column<ContactRow>& found) {
    return CylinderContacts(inputs, settings, h, pairs, p, found).run(range);
}

}  // namespace skerry
