// Part of a split impulse that concerns joints, and the distance that capsules and cylinders lose by turning.
#pragma once

#include <span>

#include "systems/solver/operators/body_operator.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Contacts are solved for straight motion of their points. Points on the axis of a capsule or the surface of a
/// cylinder deviate from it: a spinning capsule that is pressed turns its ends further towards the touched surface.
/// This loss in each step would use up the contact distance (docs/methods/rigid_bodies.md 6.2). In joints, locked rows
/// hold during the push, and axes stay within their limits for push and step together. The impulses of the push on
/// joints use a workspace that the method no longer needs.
class PushedBodies {
public:
    /// `row`, `rigid`: contacts and rigid bodies of the region. The impulses on the bodies must be written to
    /// `stage.out` already.
    PushedBodies(const RegionStage& stage, std::span<const Index> row, std::span<const Index> rigid,
                 const BodyMemory& memory, const BodyOperator& op);

    /// True if the region has a capsule or a cylinder.
    bool any_turns() const { return any_turns_; }
    /// Speed along the normal at which a contact loses distance by rotation, beyond the approach by the velocities and
    /// pseudo velocities. At most 0; 0 below rounding [m/s]
    Real loss(std::size_t i, std::span<const Vec4> push) const;
    /// One sweep over the joints. Returns the size of the change [J]
    Real sweep_joints(std::span<Vec4> push) const;

private:
    AxisBounds bounds(std::size_t at, const JointLaw& law) const;

    const RegionStage& stage_;
    std::span<const Index> row_;
    const BodyMemory& memory_;
    const BodyOperator& op_;
    bool any_turns_;
};

}  // namespace skerry
