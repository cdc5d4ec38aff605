// An arm on a hinge, for tests of joints.
#pragma once

#include "skerry/joint.h"
#include "tests/support/worlds.h"

namespace skerry::test::hinged_arm {

inline constexpr Real length = 0.4, side = 0.04, reach = 0.2;  // of an arm along x from the hinge at the origin [m]
inline constexpr Real mass = 1000 * side * side * length;      // kg
// moment of inertia about the hinge [kg m^2]
inline constexpr Real inertia = mass * (length * length + side * side) / 12 + mass * reach * reach;
inline constexpr Real weight_moment = mass * standard_gravity * reach;  // for the horizontal arm [N m]
inline constexpr Real step = 1.0 / 500;                                 // s
inline const Vec3 down(0, 0, -standard_gravity);

/// An arm on a hinge. A rotation about -y raises it.
struct Arm {
    World world;
    BodyHandle body;
    JointHandle hinge;

    explicit Arm(const JointSettings& joint, const Vec3& gravity = Vec3::Zero(), bool sleep = false)
        : world([&] {
              Settings settings = accurate(gravity, 1e-10);
              settings.step_size = step;
              settings.sleep = sleep;
              return settings;
          }()) {
        body = world.add_body(
            mesh::box({length, side, side}, {2, 1, 1}),
            {.material = world.add_material({}), .position = {reach, 0, 0}, .dynamics = BodyDynamics::rigid});
        JointSettings settings = joint;
        settings.kind = JointKind::hinge;
        settings.first = body;
        settings.axis = {0, -1, 0};
        hinge = Joints(world).add(settings);
    }
    JointState state() { return Joints(world).state(hinge); }
    /// Gives the arm an angular velocity about the hinge [rad/s].
    void spin(Real speed) { world.set_velocity(body, Vec3(0, 0, speed * reach), Vec3(0, -speed, 0)); }
};

}  // namespace skerry::test::hinged_arm
