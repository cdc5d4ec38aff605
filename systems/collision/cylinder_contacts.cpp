#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/cylinders/cylinder_touches.h"
#include "systems/collision/cylinders/rigid_cylinder.h"
#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_contacts.h"

namespace skerry {

namespace {

// Lower bound of the ratio between the greatest displacement of a rim node of a cylinder and that of any rim point. The
// travel of a body is measured at its nodes only, but a rim point between two nodes can move further than both.
constexpr Real rim_node_fraction = 0.95;

// An edge counts as parallel to the axis of a cylinder if the sine of the angle between them is below this limit. Such
// an edge touches the curved side of the cylinder along a part of its length, or not at all.
constexpr Real parallel_sine = 1e-3;

// The distance along an edge counts as constant at a point if the magnitude of its derivative is at most this value.
constexpr Real straight_slope = 1e-7;

// Numbers of the contact points between a cylinder and a triangle: 0 to 2 are the corners of the triangle. Then follow
// eight numbers for each edge of the triangle and nine for each rim of the cylinder.
constexpr Index first_edge_number = 3, numbers_per_edge = 8,
                first_rim_number = first_edge_number + 3 * numbers_per_edge;
static_assert(first_rim_number + 2 * RimPoints::max_per_rim <= touches_of_triangle);

// A rim point whose projection lies beside a face by less than this fraction of the edge length counts as above the
// face, so that no rim point is lost between two faces by rounding errors.
constexpr Real seam_fraction = 1e-9;

class CylinderContacts : PairContacts {
public:
    using PairContacts::PairContacts;

    void test(Index c) {
        if (kind == PairKind::collider)
            against_shape(c, inputs.collider.geometry[second], inputs.collider.motion[second],
                          second_local(candidates[c].feature));
        else if (inputs.body.core_nodes[second] == 0)
            against_triangle(c, candidates[c]);
        else if (is_cylinder(inputs, second))
            against_cylinder(c, cylinder_at_start(inputs, second));
        else
            against_core(c);
    }
    Real least_distance() const { return smallest_distance_; }

private:
    /// Stores asleep_until of candidate c, the travel bound of the pair below which the candidate needs no test.
    /// `distance`: lower bound of the distance between the two surfaces [m]. Returns true if the contact points of the
    /// candidate must be computed in this step.
    bool store_distance(Index c, Real distance) {
        smallest_distance_ = std::min(smallest_distance_, distance);
        asleep_until[c] = travel_base + (distance > 0 ? rim_node_fraction : 1) * distance - scale.shell;
        return distance <= near_surface();
    }
    /// Tests whether `bound`, a lower bound of the distance, already shows that candidate c has no contact in this
    /// step. If so, stores asleep_until with it and returns true. Otherwise the caller must compute the contact points,
    /// and store asleep_until with their sharper bound.
    bool is_far(Index c, Real bound) { return bound > near_surface() && !store_distance(c, bound); }
    Real near_surface() const { return contact_limit - scale.radii; }

    void against_triangle(Index c, const Candidate& candidate) {
        const Index t = candidate.second;
        const TriangleTable& table = inputs.surface.triangles;
        const auto& node = table.node[t];
        const LocalFace face{local(node[0]), local(node[1]), local(node[2])};
        if (!store_distance(c, distance_bound(cylinder_.geometry, face))) return;
        for (std::size_t k = 0; k < 3; ++k)
            if (table.owned_vertices[t] >> k & 1) corner(candidate, k, face[k]);
        for (std::size_t k = 0; k < 3; ++k)
            if (table.owned_edges[t] >> k & 1) edge(candidate, k, face[k], face[(k + 1) % 3]);
        rims(c, candidate, face);
    }

    void corner(const Candidate& candidate, std::size_t k, const Vec3& at) {
        const SurfacePoint on = local_distance(cylinder_.geometry, at, 0);
        if (!(on.distance <= near_surface())) return;
        const Index vertex = inputs.surface.triangles.vertex[candidate.second][k];
        const CylinderRegion region = nearest_region(on.normal);
        const Vec3 normal = -(cylinder_.motion.rotation * on.normal);
        bool is_contact = region == CylinderRegion::end;
        if (region == CylinderRegion::side)
            is_contact = vertex_can_touch_axis(inputs.surface, inputs.position, vertex,
                                               cylinder_.world({0, 0, at[2]}) - cylinder_.world(at),
                                               cylinder_.motion.rotation.col(2), scale);
        if (region == CylinderRegion::rim)
            is_contact = vertex_can_touch_point(inputs.surface, inputs.position, vertex,
                                                std::max(std::abs(on.distance), scale.edge) * normal, scale);
        std::array<Real, 3> weight{};
        weight[k] = 1;
        if (is_contact) add_touch(candidate, static_cast<Index>(k), weight, normal, on.distance);
    }

    void edge(const Candidate& candidate, std::size_t k, const Vec3& a, const Vec3& b) {
        if (!(edge_distance(cylinder_.geometry, 0, a, b) <= near_surface())) return;
        const EdgeContact contact = edge_contact(cylinder_.geometry, 0, a, b);
        const Vec3 along = b - a;
        const bool parallel = along.head<2>().norm() <= parallel_sine * along.norm();
        for (std::size_t i = 0; i < contact.count; ++i) {
            const EdgePoint& touch = contact.point[i];
            if (!(touch.on.distance <= near_surface())) continue;
            const Vec3 normal = -(cylinder_.motion.rotation * touch.on.normal);
            // A nearly flat edge, whose faces have almost the same normal, makes a contact in two cases only: with an
            // end of the cylinder, or where it crosses the curved side and is perpendicular to the contact normal.
            //
            // Elsewhere the faces support the cylinder. A contact at the edge would act as a bump, for example if the
            // edge is parallel to a rolling cylinder and ahead of it.
            const CylinderRegion region = nearest_region(touch.on.normal);
            const bool straight_on = std::abs(touch.on.normal.dot(along)) <= straight_slope * along.norm();
            const bool nearly_flat =
                region == CylinderRegion::end || (region == CylinderRegion::side && !parallel && straight_on);
            if (!edge_can_touch_along(inputs.surface, inputs.position,
                                      inputs.surface.triangles.edge[candidate.second][k], normal, nearly_flat))
                continue;
            std::array<Real, 3> weight{};
            weight[k] = 1 - touch.s;
            weight[(k + 1) % 3] = touch.s;
            add_touch(candidate, first_edge_number + numbers_per_edge * static_cast<Index>(k) + touch.number, weight,
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
            if (!(height <= near_surface() && -height <= scale.face_depth)) continue;
            const PointTriangle closest = closest_point_on_triangle(point.at, face[0], face[1], face[2]);
            const Vec3 beside = closest.nearest + height * normal - point.at;
            if (closest.region != TriangleRegion::face && !(beside.norm() <= seam_fraction * scale.edge)) continue;
            if (height < 0 && !is_truly_behind(c, point.at, -height)) continue;
            add_touch(candidate, first_rim_number + point.number, closest.weight, cylinder_.motion.rotation * normal,
                      height);
        }
    }

    /// True if a point of the cylinder has entered the body through the face of candidate c. The result is false if
    /// contacts and find_crossings keep the two surfaces apart, because no point can have entered then.
    bool is_truly_behind(Index c, const Vec3& point, Real depth) const {
        return !held_apart && depth <= scale.face_depth && is_nearest(c, depth, [&](Index i) {
            const auto& node = inputs.surface.triangles.node[candidates[i].second];
            return closest_point_on_triangle(point, local(node[0]), local(node[1]), local(node[2])).distance_squared;
        }) && !is_outside(inputs, second, cylinder_.world(point));
    }

    void add_touch(const Candidate& candidate, Index number, const std::array<Real, 3>& weight, const Vec3& normal,
                   Real distance) {
        const auto& node = inputs.surface.triangles.node[candidate.second];
        Vec3 point = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) point += weight[k] * inputs.position[node[k]];
        add_if_reached(candidate.feature, number, node, weight, {point, normal, distance, scale.shell},
                       speed_against(cylinder_.velocity_at(point), node));
    }

    /// Adds a contact if its gap can close in this step. `node`, `weight`: nodes of the other body at the contact
    /// point, and their weights. All weights are zero if the other partner is a collider. `speed`: relative speed of
    /// the two partners at the contact point [m/s].
    void add_if_reached(std::uint64_t feature, Index number, const std::array<Index, 3>& node,
                        const std::array<Real, 3>& weight, const ContactGeometry& contact, Real speed) {
        if (!within_reach(contact.distance + scale.radii, speed)) return;
        add(feature_of_touch(*this, feature, number),
            kind == PairKind::collider ? ContactKind::point_collider : ContactKind::point_triangle,
            stencil_of_point({cylinder_.middle, node[0], node[1], node[2]}, weight), contact);
    }
    /// Adds a contact for each entry of `touches_`, the contact points of the cylinder and one other shape. `node`:
    /// nodes of the other shape, with the weights weight_of(touch). `speed_at(velocity, contact)`: relative speed of
    /// the two shapes at the contact point `contact`, where the cylinder has the velocity `velocity` [m/s].
    void add_touches(Index c, const std::array<Index, 3>& node, auto&& weight_of, auto&& speed_at) {
        for (const CylinderTouch& touch : touches_) {
            const Vec3 point = cylinder_.world(touch.on_other), velocity = cylinder_.velocity_at(point);
            ContactGeometry contact{point, cylinder_.motion.rotation * touch.normal, touch.distance, scale.shell};
            const Real speed = speed_at(velocity, contact);
            add_if_reached(candidates[c].feature, touch.number, node, weight_of(touch), contact, speed);
        }
    }

    /// Tests the cylinder against a sphere or a capsule.
    void against_core(Index c) {
        const Index nodes = inputs.body.core_nodes[second], begin = inputs.body.nodes[second].begin;
        const std::array<Index, 2> core{begin, begin + nodes - 1};
        const Real radius = inputs.body.round_radius[second];
        const Vec3 a = local(core[0]), b = local(core[1]);
        touches_.clear();
        if (nodes == 1) {
            if (store_distance(c, local_distance(cylinder_.geometry, a, 0).distance - radius))
                touch_ball(cylinder_.geometry, a, radius, near_surface(), touches_);
        } else if (store_distance(c, edge_distance(cylinder_.geometry, 0, a, b) - radius)) {
            touch_capsule(cylinder_.geometry, a, b, radius, near_surface(), touches_);
        }
        add_touches(
            c, {core[0], core[1], core[0]},
            [](const CylinderTouch& touch) {
                return std::array{touch.weight[0], touch.weight[1], Real(0)};
            },
            [&](const Vec3& velocity, const ContactGeometry&) { return speed_against(velocity, core); });
    }

    void against_cylinder(Index c, const RigidCylinder& other) {
        find_touches(c, other.geometry, other.motion, 0);
        add_touches(
            c, {other.middle, other.middle, other.middle},
            [](const CylinderTouch&) {
                return std::array<Real, 3>{1, 0, 0};
            },
            [&](const Vec3& velocity, const ContactGeometry& contact) {
                return (velocity - other.velocity_at(contact.point)).norm();
            });
    }

    void against_shape(Index c, const ColliderGeometry& geometry, const RigidMotion& motion, Index part) {
        find_touches(c, geometry, motion, part);
        add_touches(
            c, {}, [](const CylinderTouch&) { return std::array<Real, 3>{}; },
            [&](const Vec3& velocity, ContactGeometry& contact) {
                contact.surface_velocity = velocity_at(motion, contact.point);
                return (velocity - contact.surface_velocity).norm();
            });
    }

    void find_touches(Index c, const ColliderGeometry& other, const RigidMotion& motion, Index part) {
        const RigidMotion pose{cylinder_.local(motion.position),
                               cylinder_.motion.rotation.transpose() * motion.rotation, Vec3::Zero(), Vec3::Zero()};
        touches_.clear();
        if (is_far(c, shape_distance_bound(cylinder_.geometry, other, part, pose, touches_))) return;
        touch_shape(cylinder_.geometry, other, part, pose, near_surface(), touches_);
        store_distance(c, shape_distance_bound(cylinder_.geometry, other, part, pose, touches_));
    }

    Vec3 local(Index node) const { return cylinder_.local(inputs.position[node]); }

    const RigidCylinder cylinder_ = cylinder_at_start(inputs, first);
    CylinderTouches touches_;
    Real smallest_distance_ = infinity;
};

}  // namespace

Real find_cylinder_contacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                            Range range, PairTable& pairs, Column<ContactRow>& found) {
    CylinderContacts contacts(inputs, settings, h, pairs, p, found);
    for_each_awake(settings, pairs, p, range, [&](Index c) { contacts.test(c); });
    return contacts.least_distance();
}

}  // namespace skerry
