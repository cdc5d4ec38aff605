// Additions to the split impulse: it also holds joints, and compensates the loss of gap when capsules and cylinders
// rotate.
#pragma once

#include <span>

#include "systems/solver/operators/body_operator.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Parts of the split impulse that compensate the rotation of capsules and cylinders, and parts that hold joints.
///
/// Rotation: contacts are solved for straight motion of their points, but points on the axis of a capsule or on the
/// surface of a cylinder move on arcs. Without compensation, the lost gap would use up part of the contact distance in
/// each step (docs/methods/rigid_bodies.md 6.2).
///
/// Joints: locked rows hold during the push, and axes stay within their limits for push and step together. The joint
/// impulses of the push are stored in slot 0 of the workspace, which the method no longer needs.
class PushedBodies {
public:
    /// `row` lists the contacts, `rigid` the rigid bodies of the region. The contact impulses on the bodies must
    /// already be in `stage.out`.
    PushedBodies(const RegionStage& stage, std::span<const Index> row, std::span<const Index> rigid,
                 const BodyMemory& memory, const BodyOperator& op);

    /// True if the region has a capsule or a cylinder.
    bool any_rotation() const { return any_rotation_; }
    /// Rate of change of the gap of contact i because its point moves on an arc instead of a straight line [m/s].
    /// Negative if the gap shrinks by more than the rounding error, otherwise 0. The body moves with its velocities and
    /// the pseudo velocities `push`.
    Real loss(std::size_t i, std::span<const Vec4> push) const;
    /// Does one sweep over the joints. Returns the squared energy norm of the impulse change [J]
    Real sweep_joints(std::span<Vec4> push) const;

private:
    AxisBounds bounds(std::size_t at, const JointLaw& law) const;

    const RegionStage& stage_;
    std::span<const Index> row_;
    const BodyMemory& memory_;
    const BodyOperator& op_;
    bool any_rotation_;
};

}  // namespace skerry
