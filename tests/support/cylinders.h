// Worlds of equal cylinders.
#pragma once

#include "tests/support/capsules.h"

namespace skerry::test::cylinders {

using capsules::add_floor, capsules::along_x, capsules::along_y, capsules::density, capsules::Floor, capsules::g,
    capsules::kept, capsules::pi, capsules::steps_of;

inline constexpr Real radius = 0.1, height = 0.3;
inline const Real mass = pi * density * radius * radius * height, axial = mass * radius * radius / 2,
                  across = mass * (radius * radius / 4 + height * height / 12);

struct Cylinders : capsules::Capsules {
    using Capsules::Capsules;

    BodyHandle add(const Vec3& position, const Vec3& rotation, const Vec3& velocity = Vec3::Zero(),
                   const Vec3& spin = Vec3::Zero(), const std::string& name = "") {
        return world.add_body(Cylinder{radius, height}, placed(position, rotation, velocity, spin, name));
    }
    Vec3 middle(BodyHandle body) const { return world.positions(body)[0]; }
    Vec3 axis(BodyHandle body) const { return (world.positions(body)[1] - middle(body)).normalized(); }
    Vec3 local(BodyHandle body, const Vec3& point) const {
        const RigidBodyTable& table = WorldAccess::state_of(world).model.rigid_bodies;
        return table.rotation[row(body)].transpose() * (point - middle(body));
    }
    /// Distance of a point from a cylinder, negative inside [m].
    Real distance(BodyHandle body, const Vec3& point) const {
        const Vec3 at = local(body, point);
        const Real out = at.head<2>().norm() - radius, up = std::abs(at.z()) - height / 2;
        return out > 0 && up > 0 ? std::hypot(out, up) : std::max(out, up);
    }
    /// Height of the lowest point of a cylinder [m].
    Real lowest(BodyHandle body) const {
        const Real up = std::abs(axis(body).z());
        return middle(body).z() - height / 2 * up - radius * std::sqrt(std::max(Real(0), 1 - up * up));
    }
};

}  // namespace skerry::test::cylinders
