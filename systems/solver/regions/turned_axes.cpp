#include "systems/solver/regions/turned_axes.h"

#include <Eigen/Geometry>
#include <cmath>

#include "systems/geometry/free_turn.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Height along the normal of a point on a cylinder after the axis has turned, without rotation about the axis. For the
/// lowest point of a rim: the height of the point that is lowest then, because the lowest point moves around the rim
/// [m]
Real height_after(const Vec3& place, const Vec3& axis, const Vec3& axis_then, const Vec3& normal) {
    constexpr Real lowest = 1e-9, least_tilt = 1e-4;  // of the radius; [rad], below it many rim points are lowest
    const Real up = axis.dot(place), radius = (place - up * axis).norm();
    const auto lowest_of_rim = [&](const Vec3& of) { return up * of.dot(normal) - radius * of.cross(normal).norm(); };
    if (axis.cross(normal).norm() > least_tilt && normal.dot(place) <= lowest_of_rim(axis) + lowest * radius)
        return lowest_of_rim(axis_then);
    const Vec3 about = axis.cross(axis_then);
    const Real sine = about.norm();
    if (!(sine > 0)) return normal.dot(place);
    return normal.dot(rotation_matrix(std::atan2(sine, axis.dot(axis_then)) / sine * about) * place);
}

}  // namespace

Real TurnedAxes::loss(Index row, const RigidPart& part, std::span<const Vec4> push) const {
    constexpr Real rounding = 1e-12;  // as in push_slop [m]
    const RigidInputs& rigid = stage_.inputs.rigid;
    const Vec3& normal = stage_.inputs.normal[static_cast<std::size_t>(row)];
    Real along = 0;  // [m]
    for (const RigidTerm& term : part.terms()) {
        const auto r = static_cast<std::size_t>(term.row);
        const bool cylinder = rigid.is_cylinder(term.row);
        if (!cylinder && !rigid.is_capsule(term.row)) continue;
        // Point relative to the centre; for a capsule on its axis.
        const Vec3 place =
            cylinder ? Vec3(term.arm.head<3>()) : Vec3(term.arm.head<3>() + rigid.radius(term.row) * normal);
        const Vec3 angular_momentum =
            rigid.spins.angular_momentum[r] + (rigid.spins.moment_kick[r] + stage_.out.contact_moment[r]);
        const Vec3 spin = velocity_[static_cast<std::size_t>(term.slot) + 1].head<3>(),
                   push_spin = push[static_cast<std::size_t>(term.slot) + 1].head<3>();
        const Mat3 turned = turned_freely(rigid.rotation[r], rigid.moments[r], angular_momentum, stage_.h);
        const Mat3 pushed = rotation_matrix(stage_.h * push_spin);
        const Vec3 straight = stage_.h * (spin + push_spin).cross(place);
        if (cylinder) {
            along += height_after(place, rigid.rotation[r].col(2), pushed * turned.col(2), normal) -
                     normal.dot(place + straight);
            continue;
        }
        const Vec3 there = pushed * (turned * (rigid.rotation[r].transpose() * place));
        along += normal.dot(there - place - straight);
    }
    return along < -rounding ? along / stage_.h : 0;
}

}  // namespace skerry
