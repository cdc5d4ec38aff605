// Conversion of points between world coordinates and the coordinate frame of a rigid shape.
#pragma once

#include <Eigen/Geometry>

#include "components/collider_table.h"

namespace skerry {

/// Converts a point from world coordinates to the coordinate frame of a shape [m].
inline Vec3 to_local(const RigidMotion& motion, const Vec3& point) {
    return motion.rotation.transpose() * (point - motion.position);
}
inline Vec3 to_world(const RigidMotion& motion, const Vec3& point) {
    return motion.position + motion.rotation * point;
}
/// Velocity of a rigid shape at a point in world coordinates [m/s].
inline Vec3 velocity_at(const RigidMotion& motion, const Vec3& point) {
    return motion.velocity + motion.angular_velocity.cross(point - motion.position);
}

}  // namespace skerry
