// Poses and motions of rigid cylinders. They are computed from the core nodes of the bodies (BodyTable::core_nodes).
#pragma once

#include "components/collider_table.h"
#include "components/node_block_table.h"
#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/step_motion.h"
#include "systems/collision/narrow/rigid_frame.h"

namespace skerry {

/// A rigid cylinder, with the geometry and motion of a collider. Features of other bodies can thus be tested in its
/// frame.
struct RigidCylinder {
    ColliderGeometry geometry;
    RigidMotion motion;
    Index middle;  // row in NodeTable of the node at the centre of the cylinder

    Vec3 local(const Vec3& point) const { return to_local(motion, point); }
    Vec3 world(const Vec3& point) const { return to_world(motion, point); }
    Vec3 velocity_at(const Vec3& point) const { return skerry::velocity_at(motion, point); }
};

inline bool is_cylinder(const CollisionInputs& inputs, Index body) {
    return inputs.body.core_nodes[body] == cylinder_core_nodes;
}
inline bool has_cylinder(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return is_cylinder(inputs, pairs.first[p]) ||
           (pairs.kind[p] != PairKind::collider && is_cylinder(inputs, pairs.second[p]));
}

/// The cylinder at the start of the step, with the velocities that it has at this time.
RigidCylinder cylinder_at_start(const CollisionInputs& inputs, Index body);

/// The cylinder at the start of the step, with the constant velocities that move it to its position at the end. The
/// angular velocity belongs to the smallest rotation that turns the axis to its final direction, because rotation about
/// the axis does not change the surface.
RigidCylinder cylinder_in_step(const CollisionInputs& inputs, const StepMotion& motion, Index body);

}  // namespace skerry
