// Points of the world as seen from a rigid shape.
#pragma once

#include <Eigen/Geometry>

#include "components/collider_table.h"

namespace skerry {

/// A point of the world in the frame of a shape [m].
inline Vec3 to_local(const RigidMotion& motion, const Vec3& point) {
    return motion.rotation.transpose() * (point - motion.position);
}
inline Vec3 to_world(const RigidMotion& motion, const Vec3& point) {
    return motion.position + motion.rotation * point;
}
/// Velocity of the shape at a point of the world [m/s].
inline Vec3 velocity_at(const RigidMotion& motion, const Vec3& point) {
    return motion.velocity + motion.angular_velocity.cross(point - motion.position);
}

}  // namespace skerry
