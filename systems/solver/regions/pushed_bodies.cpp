#include "systems/solver/regions/pushed_bodies.h"

#include <algorithm>

namespace skerry {

PushedBodies::PushedBodies(const TurnedAxes& axes, const BodyMemory& memory, std::span<const Index> row,
                           const BodyOperator& op)
    : axes_(axes), memory_(memory), row_(row), op_(op) {
    for (std::size_t at = row.size(); at < memory.contact.size(); ++at) memory.workspace[0][at].setZero();
}

Real PushedBodies::sweep_joints(std::span<Vec4> push_velocity) const {
    const std::span<Vec4> impulse = memory_.workspace[0];
    Real size = 0;
    for (std::size_t at = row_.size(); at < memory_.contact.size(); ++at) {
        const auto i = static_cast<Index>(at);
        const RigidPart& part = memory_.part[at];
        const JointLaw& law = *op_.joint(i);
        const Mat3 frame = matrix_of(part.frame);
        const Vec3 r = frame.transpose() * impulse[at].head<3>();
        const Vec3 u = frame.transpose() * op_.velocity_at(i, push_velocity.data()).head<3>();
        const Vec4 next = padded(frame * law.answer(bounds(at, law), u - law.block * r));
        const Vec4 change = next - impulse[at];
        if (change.isZero(0)) continue;
        op_.apply_undeformed(i, change, push_velocity.data());
        impulse[at] = next;
        size += op_.inner(i, change, change);
    }
    return size;
}

AxisBounds PushedBodies::bounds(std::size_t at, const JointLaw& law) const {
    const Real along = memory_.part[at].frame[2].dot(op_.velocity(static_cast<Index>(at)));
    return {std::min(law.axis.low - along, Real(0)), std::max(law.axis.high - along, Real(0)), 0, 0};
}

}  // namespace skerry
