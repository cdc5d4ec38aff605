#include <algorithm>
#include <array>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/collision/pair_contacts.h"

namespace skerry {

namespace {

class ColliderContacts : PairContacts {
public:
    using PairContacts::PairContacts;

    void test(Index c) {
        const Candidate& candidate = candidates[c];
        if (is_edge_edge(candidate.feature))
            edge(c, candidate);
        else if (is_face_collider(candidate.feature))
            face(c, candidate);
        else
            point(c, candidate);
    }
    Real least_distance() const { return least_; }

private:
    void point(Index c, const Candidate& candidate) {
        const Index node = inputs.surface.vertices.node[candidate.first];
        const SurfacePoint nearest =
            distance_to_collider_part(geometry_, motion_, second_local(candidate.feature), inputs.position[node]);
        asleep_until[c] = travel_base + nearest.distance - scale.contact_distance;
        least_ = std::min(least_, nearest.distance - scale.radii);
        if (!(nearest.distance <= contact_limit)) return;
        const Vec3 velocity = velocity_at(motion_, nearest.point);
        if (!within_reach(nearest.distance, speed_against(velocity, std::array{node}))) return;
        add(candidate.feature, ContactKind::point_collider, {{node, node, node, node}, {1, 0, 0, 0}},
            {nearest.point, nearest.normal, nearest.distance, scale.contact_distance, velocity});
    }

    void edge(Index c, const Candidate& candidate) {
        const auto& node = inputs.surface.edges.node[candidate.first];
        const std::array<Vec3, 2> end{local(node[0]), local(node[1])};
        const Index part = second_local(candidate.feature) / contacts_of_edge;
        const Real flat = flat_reach(geometry_, end);
        const Real distance = edge_distance(geometry_, part, end[0], end[1]);
        asleep_until[c] = travel_base + std::max(distance - scale.contact_distance, flat);
        if (!(distance <= contact_limit) || flat >= 0) {
            least_ = std::min(least_, std::max(distance - scale.radii, flat));
            return;
        }
        if (motion_.stands_still() && is_convex_part(geometry_, part) &&
            !within_reach(distance, speed_against(Vec3::Zero(), node))) {
            // `distance` is a lower bound for all points of the edge, and no node is fast enough to close it in this
            // step. So the contact points are not computed. The edge may be the axis of a capsule, whose surface is
            // nearer by the radius.
            least_ = std::min(least_, distance - scale.radii);
            return;
        }
        const EdgeContact contact = edge_contact(geometry_, part, end[0], end[1]);
        least_ = std::min(least_, contact.nearest - scale.radii);
        for (std::size_t i = 0; i < contact.count; ++i) {
            const EdgePoint& touch = contact.point[i];
            const Vec3 point = to_world(motion_, touch.on.point), velocity = velocity_at(motion_, point);
            if (!within_reach(touch.on.distance, speed_against(velocity, node))) continue;
            add(candidate.feature + static_cast<std::uint64_t>(touch.number), ContactKind::edge_collider,
                {{node[0], node[1], node[0], node[0]}, {1 - touch.s, touch.s, 0, 0}},
                {point, motion_.rotation * touch.on.normal, touch.on.distance, scale.contact_distance, velocity});
        }
    }

    void face(Index c, const Candidate& candidate) {
        const auto& node = inputs.surface.triangles.node[candidate.first];
        const LocalFace corner = face_of(candidate.first);
        const FaceContact contact = face_contact(geometry_, first_local(candidate.feature), corner);
        const Real flat = flat_reach(geometry_, corner);
        asleep_until[c] = travel_base + std::max(contact.nearest - face_zone(scale), flat);
        least_ = std::min(least_, std::max({contact.nearest, contact.distance, flat}));
        if (!contact.above || flat >= 0 || !(contact.distance <= contact_limit)) return;
        const Vec3 point = to_world(motion_, contact.point.at - contact.point.radius * contact.normal),
                   velocity = velocity_at(motion_, point);
        if (!within_reach(contact.distance, speed_against(velocity, node))) return;
        // Depth behind the face of the point contact.point.at: a corner, a rim point, or the centre of a sphere or of
        // an end of a capsule [m]. contact.distance is its height above the face, minus the radius.
        const Real depth = -(contact.distance + contact.point.radius);
        if (depth > 0 && !is_truly_behind(c, contact.point.at, depth)) return;
        const auto& weight = contact.closest.weight;
        add(candidate.feature, ContactKind::face_collider,
            {{node[0], node[1], node[2], node[0]}, {weight[0], weight[1], weight[2], 0}},
            {point, -(motion_.rotation * contact.normal), contact.distance, scale.contact_distance, velocity});
    }

    /// True if the collider point has entered the body through the face of candidate c. False in three cases:
    /// - The point is deeper than face_depth and may have come from the other side of a thin part.
    /// - Another face is nearer.
    /// - The point is outside the body, in a fold of its surface.
    bool is_truly_behind(Index c, const Vec3& point, Real depth) const {
        return depth <= scale.face_depth &&
               is_nearest(c, depth,
                          [&](Index i) {
                              const LocalFace other = face_of(candidates[i].first);
                              return closest_point_on_triangle(point, other[0], other[1], other[2]).distance_squared;
                          }) &&
               !is_outside(inputs, first, to_world(motion_, point));
    }

    LocalFace face_of(Index triangle) const {
        const auto& node = inputs.surface.triangles.node[triangle];
        return {local(node[0]), local(node[1]), local(node[2])};
    }
    Vec3 local(Index node) const { return to_local(motion_, inputs.position[node]); }

    const ColliderGeometry& geometry_ = inputs.collider.geometry[second];
    const RigidMotion& motion_ = inputs.collider.motion[second];
    Real least_ = infinity;
};

}  // namespace

Real find_collider_contacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                            Range range, PairTable& pairs, Column<ContactRow>& found) {
    ColliderContacts contacts(inputs, settings, h, pairs, p, found);
    for_each_awake(settings, pairs, p, range, [&](Index c) { contacts.test(c); });
    return contacts.least_distance();
}

}  // namespace skerry
