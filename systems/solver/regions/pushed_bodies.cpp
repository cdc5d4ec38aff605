#include "systems/solver/regions/pushed_bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/geometry/free_turn.h"
#include "systems/geometry/rotation.h"

namespace skerry {
namespace {

/// Height of a point of a cylinder above its centre, measured along `normal`, after a rotation that tilts the axis from
/// `axis` to `axis_then` [m]. `point`: the point before the rotation, relative to the centre.
///
/// For the lowest point of a rim, the result is the height of the point that is lowest after the rotation, because the
/// contact moves around the rim as the cylinder tilts.
Real height_after(const Vec3& point, const Vec3& axis, const Vec3& axis_then, const Vec3& normal) {
    // `lowest`: a point counts as the lowest of its rim if it is higher than the lowest one by at most this fraction of
    // the radius. `least_tilt`: below this angle between axis and normal [rad], many points of a rim would count, so
    // `point` itself is rotated.
    constexpr Real lowest = 1e-9, least_tilt = 1e-4;
    const Real height = axis.dot(point), radius = (point - height * axis).norm();
    const auto lowest_of_rim = [&](const Vec3& direction) {
        return height * direction.dot(normal) - radius * direction.cross(normal).norm();
    };
    if (axis.cross(normal).norm() > least_tilt && normal.dot(point) <= lowest_of_rim(axis) + lowest * radius)
        return lowest_of_rim(axis_then);
    const Vec3 about = axis.cross(axis_then);
    const Real sine = about.norm();
    if (!(sine > 0)) return normal.dot(point);
    return normal.dot(rotation_matrix(std::atan2(sine, axis.dot(axis_then)) / sine * about) * point);
}

}  // namespace

PushedBodies::PushedBodies(const RegionStage& stage, std::span<const Index> row, std::span<const Index> rigid,
                           const BodyMemory& memory, const BodyOperator& op)
    : stage_(stage), row_(row), memory_(memory), op_(op), any_rotation_(std::ranges::any_of(rigid, [&](Index r) {
          return stage.inputs.rigid.is_capsule(r) || stage.inputs.rigid.is_cylinder(r);
      })) {
    for (std::size_t at = row.size(); at < memory.contact.size(); ++at) memory.workspace[0][at].setZero();
}

Real PushedBodies::loss(std::size_t i, std::span<const Vec4> push) const {
    if (!any_rotation_ || op_.limits(static_cast<Index>(i)).ties()) return 0;
    constexpr Real rounding = 1e-12;  // rounding error of positions, as in push_slop [m]
    const RigidInputs& rigid = stage_.inputs.rigid;
    const Vec3& normal = stage_.inputs.normal[static_cast<std::size_t>(row_[i])];
    Real along = 0;  // change of the gap by arcs instead of straight lines [m]
    for (const RigidTerm& term : memory_.part[i].terms()) {
        const auto r = static_cast<std::size_t>(term.row);
        const bool cylinder = rigid.is_cylinder(term.row);
        if (!cylinder && !rigid.is_capsule(term.row)) continue;
        // Contact point relative to the centre. For a capsule the point is on the axis.
        const Vec3 point =
            cylinder ? Vec3(term.arm.head<3>()) : Vec3(term.arm.head<3>() + rigid.radius(term.row) * normal);
        const Vec3 angular_momentum =
            rigid.spins.angular_momentum[r] + (rigid.spins.moment_kick[r] + stage_.out.contact_moment[r]);
        const Vec3 spin = memory_.velocity[static_cast<std::size_t>(term.slot) + 1].head<3>(),
                   push_spin = push[static_cast<std::size_t>(term.slot) + 1].head<3>();
        const Mat3 turned = turned_freely(rigid.rotation[r], rigid.moments[r], angular_momentum, stage_.h);
        const Mat3 pushed = rotation_matrix(stage_.h * push_spin);
        const Vec3 straight = stage_.h * (spin + push_spin).cross(point);
        if (cylinder) {
            along += height_after(point, rigid.rotation[r].col(2), pushed * turned.col(2), normal) -
                     normal.dot(point + straight);
            continue;
        }
        const Vec3 rotated = pushed * (turned * (rigid.rotation[r].transpose() * point));
        along += normal.dot(rotated - point - straight);
    }
    return along < -rounding ? along / stage_.h : 0;
}

Real PushedBodies::sweep_joints(std::span<Vec4> push) const {
    const std::span<Vec4> impulse = memory_.workspace[0];
    Real size = 0;
    for (std::size_t at = row_.size(); at < row_.size() + memory_.joint.size(); ++at) {
        const auto i = static_cast<Index>(at);
        const RigidPart& part = memory_.part[at];
        const JointLaw& law = *op_.joint(i);
        if (law.mimic != 0) {
            if (op_.mobility(i) > 0)
                size += op_.solve_mimic(
                    i, 1, [&](Index k) { return op_.velocity_at(k, push.data()); },
                    [&](Index k, const Vec4& change) {
                        op_.apply_undeformed(k, change, push.data());
                        impulse[static_cast<std::size_t>(k)] += change;
                    });
            continue;
        }
        const Mat3 frame = matrix_of(part.frame);
        const Vec3 r = frame.transpose() * impulse[at].head<3>();
        const Vec3 u = frame.transpose() * op_.velocity_at(i, push.data()).head<3>();
        const Vec4 next = padded(frame * law.solve(bounds(at, law), u - law.block * r));
        const Vec4 change = next - impulse[at];
        if (change.isZero(0)) continue;
        op_.apply_undeformed(i, change, push.data());
        impulse[at] = next;
        size += op_.inner(i, change, change);
    }
    return size;
}

AxisBounds PushedBodies::bounds(std::size_t at, const JointLaw& law) const {
    const Real along = memory_.part[at].frame[2].dot(op_.velocity(static_cast<Index>(at)));
    return {.low = std::min(law.axis.low - along, Real(0)), .high = std::max(law.axis.high - along, Real(0))};
}

}  // namespace skerry
