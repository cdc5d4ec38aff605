#include "systems/collision/cylinders/rigid_cylinder.h"

#include <Eigen/Geometry>
#include <cmath>

namespace skerry {

namespace {

RigidCylinder placed(const CollisionInputs& inputs, Index body) {
    const Index first = inputs.body.nodes[body].begin;
    const auto at = [&](Index k) -> const Vec3& { return inputs.position[first + k]; };
    const auto rest = [&](Index k) -> const Vec3& { return inputs.rest_position[first + k]; };
    const Vec3 up = (at(1) - at(0)).normalized(), across = at(2) - at(1);
    RigidCylinder found{{ColliderShape::cylinder, {(rest(2) - rest(1)).norm(), (rest(1) - rest(0)).norm(), 0}},
                        {at(0), Mat3::Identity(), Vec3::Zero(), Vec3::Zero()},
                        first};
    const Vec3 aside = (across - up.dot(across) * up).normalized();
    found.motion.rotation << aside, up.cross(aside), up;
    return found;
}

}  // namespace

RigidCylinder cylinder_at_start(const CollisionInputs& inputs, Index body) {
    RigidCylinder found = placed(inputs, body);
    const Index first = found.middle;
    const auto velocity = [&](Index k) -> const Vec3& { return inputs.velocity[first + k]; };
    const Vec3 up = found.motion.rotation.col(2), aside = found.motion.rotation.col(1);
    const Real about = aside.dot(velocity(2) - velocity(1)) / found.geometry.size[0];
    found.motion.velocity = velocity(0);
    found.motion.angular_velocity = up.cross(velocity(1) - velocity(0)) / found.geometry.size[1] + about * up;
    return found;
}

RigidCylinder cylinder_in_step(const CollisionInputs& inputs, const StepMotion& motion, Index body) {
    RigidCylinder found = placed(inputs, body);
    const Index first = found.middle;
    const Vec3 displacement = motion.displacement(first), up = found.motion.rotation.col(2);
    const Vec3 up_then =
        (inputs.position[first + 1] + motion.displacement(first + 1) - (inputs.position[first] + displacement))
            .normalized();
    const Vec3 axis = up.cross(up_then);
    const Real sine = axis.norm();
    found.motion.velocity = displacement / motion.h;
    // `sine` is also zero if the axis has rotated by 180 degrees. The cylinder then occupies the same space as before,
    // so zero angular velocity is right, too.
    if (sine > 0) found.motion.angular_velocity = std::atan2(sine, up.dot(up_then)) / (sine * motion.h) * axis;
    return found;
}

}  // namespace skerry
