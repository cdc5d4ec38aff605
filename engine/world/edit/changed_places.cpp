#include "engine/world/edit/changed_places.h"

#include <algorithm>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/box_tree.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

/// Bounding box of the surface of a body, enlarged on all sides by the length `by` and, for a round body, by its radius
/// [m].
Aabb box_of_body(const Model& model, std::size_t body, Real by) {
    Aabb box = empty_box();
    for (const Index node :
         model.surface.vertices.node.span().subspan(static_cast<std::size_t>(model.bodies.vertices[body].begin),
                                                    static_cast<std::size_t>(model.bodies.vertices[body].size())))
        grow(box, model.nodes.position[static_cast<std::size_t>(node)]);
    by += model.bodies.round_radius[body];
    return {box.lower.array() - by, box.upper.array() + by};
}

bool reaches_behind(const Aabb& box, const RigidMotion& plane) {
    const Vec3 normal = plane.rotation.col(2);
    const Vec3 lowest = (normal.array() > 0).select(box.lower, box.upper);
    return !(normal.dot(lowest - plane.position) > 0);
}

}  // namespace

void ChangedPlaces::add_body(const Model& model, std::size_t body) {
    boxes_.push_back(box_of_body(model, body, model.bodies.contact_distance[body]));
}

void ChangedPlaces::add_collider(const Model& model, std::size_t collider, Real now) {
    const ColliderTable& table = model.colliders;
    if (const Index body = table.body[collider]; body != no_index)
        return add_body(model, static_cast<std::size_t>(body));
    const RigidPose pose = pose_at(table.script[collider], table.keyframe, table.initial[collider], now);
    const RigidMotion motion{pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()};
    if (table.geometry[collider].shape == ColliderShape::plane)
        planes_.push_back(motion);
    else
        boxes_.push_back(collider_box(table.geometry[collider], motion));
}

void ChangedPlaces::wake_near(Model& model) {
    const bool any_rests =
        std::ranges::find_if(model.bodies.asleep, [](auto asleep) { return asleep != 0; }) != model.bodies.asleep.end();
    if (any_rests) {
        const BoxTree tree(boxes_);
        for (std::size_t b = 0; b < model.bodies.asleep.size(); ++b) {
            if (!model.bodies.asleep[b]) continue;
            const Aabb box = box_of_body(model, b, model.bodies.mean_edge[b] + model.bodies.contact_distance[b]);
            bool near = std::ranges::any_of(planes_, [&](const RigidMotion& p) { return reaches_behind(box, p); });
            tree.for_each_overlap(box, [&](Index) { near = true; });
            if (near) model.wake(b);
        }
    }
    boxes_.clear();
    planes_.clear();
}

}  // namespace skerry
