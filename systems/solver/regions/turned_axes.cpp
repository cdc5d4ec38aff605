#include "systems/solver/regions/turned_axes.h"

#include <Eigen/Geometry>

#include "systems/geometry/free_turn.h"
#include "systems/geometry/rotation.h"

namespace skerry {

Real TurnedAxes::loss(Index row, const RigidPart& part, std::span<const Vec4> push) const {
    constexpr Real rounding = 1e-12;  // m, as of push_slop
    const RigidInputs& rigid = stage_.inputs.rigid;
    const Vec3& normal = stage_.inputs.normal[static_cast<std::size_t>(row)];
    Real along = 0;  // m
    for (const RigidTerm& term : part.terms()) {
        const auto r = static_cast<std::size_t>(term.row);
        if (!rigid.is_capsule(term.row)) continue;
        const Vec3 axis = term.arm.head<3>() + rigid.radius(term.row) * normal;  // the place, from the centre
        const Vec3 angular_momentum =
            rigid.spins.angular_momentum[r] + (rigid.spins.moment_kick[r] + stage_.out.contact_moment[r]);
        const Vec3 spin = velocity_[static_cast<std::size_t>(term.slot) + 1].head<3>(),
                   push_spin = push[static_cast<std::size_t>(term.slot) + 1].head<3>();
        const Mat3 turned = turned_freely(rigid.rotation[r], rigid.moments[r], angular_momentum, stage_.h);
        const Vec3 there = rotation_matrix(stage_.h * push_spin) * (turned * (rigid.rotation[r].transpose() * axis));
        along += normal.dot(there - axis - stage_.h * (spin + push_spin).cross(axis));
    }
    return along < -rounding ? along / stage_.h : 0;
}

}  // namespace skerry
