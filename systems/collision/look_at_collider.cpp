#include "systems/collision/look_at_collider.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/colliders/face_contact.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_look.h"

namespace skerry {

namespace {

class ColliderContacts : PairLook {
public:
    ColliderContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                     Index p, Column<ContactRow>& found)
        : PairLook(inputs, settings, h, pairs, p, found),
          geometry_(inputs.collider.geometry[second_]),
          motion_(inputs.collider.motion[second_]) {}

    /// Returns the least distance of the features tested, or how far they may move in a flat place if that is more [m].
    Real run(Range range) {
        for_each_awake(range, [&](Index c) { wake(c); });
        return nearest_;
    }

private:
    void wake(Index c) {
        prepare();
        const Candidate& candidate = candidates_[c];
        if (is_edge_edge(candidate.feature))
            edge(c, candidate);
        else if (is_face_collider(candidate.feature))
            face(c, candidate);
        else
            point(c, candidate);
    }

    void point(Index c, const Candidate& candidate) {
        const Index node = inputs_.surface.vertices.node[candidate.first];
        const SurfacePoint nearest =
            distance_to_collider_part(geometry_, motion_, second_local(candidate.feature), inputs_.position[node]);
        asleep_until_[c] = travel_base_ + nearest.distance - scale_.contact_distance;
        nearest_ = std::min(nearest_, nearest.distance - scale_.radii);
        if (!(nearest.distance <= near_)) return;
        const Vec3 velocity = velocity_at(nearest.point);
        if (!within_reach(nearest.distance, speed_against(velocity, std::array{node}))) return;
        add(candidate, ContactKind::point_collider, {{node, node, node, node}, {1, 0, 0, 0}}, nearest.point,
            nearest.normal, nearest.distance, scale_.contact_distance, velocity);
    }

    void edge(Index c, const Candidate& candidate) {
        const auto& node = inputs_.surface.edges.node[candidate.first];
        const std::array<Vec3, 2> end{local(node[0]), local(node[1])};
        const Index part = second_local(candidate.feature) / contacts_of_edge;
        const Real flat = flat_reach(geometry_, end);
        const Real distance = edge_distance(geometry_, part, end[0], end[1]);
        asleep_until_[c] = travel_base_ + std::max(distance - scale_.contact_distance, flat);
        if (!(distance <= near_) || flat >= 0) {
            nearest_ = std::min(nearest_, std::max(distance - scale_.radii, flat));
            return;
        }
        if (motion_.stands_still() && is_convex_part(geometry_, part) &&
            !within_reach(distance, speed_against(Vec3::Zero(), node))) {
            nearest_ = std::min(nearest_, distance - scale_.radii);  // a bound for the whole edge
            return;
        }
        const EdgeContact contact = edge_contact(geometry_, part, end[0], end[1]);
        nearest_ = std::min(nearest_, contact.nearest - scale_.radii);
        for (std::size_t i = 0; i < contact.count; ++i) {
            const EdgePoint& touch = contact.point[i];
            const Vec3 point = world(touch.on.point), velocity = velocity_at(point);
            if (!within_reach(touch.on.distance, speed_against(velocity, node))) continue;
            Candidate numbered = candidate;
            numbered.feature += static_cast<std::uint64_t>(touch.number);
            add(numbered, ContactKind::edge_collider,
                {{node[0], node[1], node[0], node[0]}, {1 - touch.s, touch.s, 0, 0}}, point,
                motion_.rotation * touch.on.normal, touch.on.distance, scale_.contact_distance, velocity);
        }
    }

    void face(Index c, const Candidate& candidate) {
        const auto& node = inputs_.surface.triangles.node[candidate.first];
        const LocalFace corner = face_of(candidate.first);
        const Index k = first_local(candidate.feature);
        const FaceContact contact = face_contact(geometry_, k, corner);
        const Real flat = flat_reach(geometry_, corner);
        asleep_until_[c] = travel_base_ + std::max(contact.nearest - face_zone(scale_), flat);
        nearest_ = std::min(nearest_, std::max({contact.nearest, contact.distance, flat}));
        if (!contact.above || flat >= 0 || !(contact.distance <= near_)) return;
        const Vec3 point = world(contact.point.at - contact.point.radius * contact.normal),
                   velocity = velocity_at(point);
        if (!within_reach(contact.distance, speed_against(velocity, node))) return;
        const Real depth = -(contact.distance + contact.point.radius);  // of the point's centre behind the face
        if (depth > 0 && !is_truly_behind(c, contact.point.at, depth)) return;
        const auto& weight = contact.closest.weight;
        add(candidate, ContactKind::face_collider,
            {{node[0], node[1], node[2], node[0]}, {weight[0], weight[1], weight[2], 0}}, point,
            -(motion_.rotation * contact.normal), contact.distance, scale_.contact_distance, velocity);
    }

    /// True if the point has come through this face. Otherwise it may be in front of the far side of a thin part,
    /// nearer to another face, or outside in a fold.
    bool is_truly_behind(Index c, const Vec3& point, Real depth) const {
        return depth <= scale_.face_depth &&
               is_nearest(c, depth,
                          [&](Index i) {
                              const LocalFace other = face_of(candidates_[i].first);
                              return closest_point_on_triangle(point, other[0], other[1], other[2]).distance_squared;
                          }) &&
               !is_outside(inputs_, first_, world(point));
    }

    LocalFace face_of(Index triangle) const {
        const auto& node = inputs_.surface.triangles.node[triangle];
        return {local(node[0]), local(node[1]), local(node[2])};
    }
    Vec3 local(Index node) const { return motion_.rotation.transpose() * (inputs_.position[node] - motion_.position); }
    Vec3 world(const Vec3& point) const { return motion_.position + motion_.rotation * point; }
    Vec3 velocity_at(const Vec3& point) const {
        return motion_.velocity + motion_.angular_velocity.cross(point - motion_.position);
    }
    /// Greatest speed of some nodes relative to `velocity` [m/s].
    Real speed_against(const Vec3& velocity, const auto& nodes) const {
        Real squared = 0;
        for (Index n : nodes) squared = std::max(squared, (inputs_.velocity[n] - velocity).squaredNorm());
        return std::sqrt(squared);
    }

    const ColliderGeometry& geometry_;
    const RigidMotion& motion_;
    Real nearest_ = std::numeric_limits<Real>::infinity();
};

}  // namespace

Real look_at_collider(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                      PairTable& pairs, Column<ContactRow>& found) {
    return ColliderContacts(inputs, settings, h, pairs, p, found).run(range);
}

}  // namespace skerry
