// Part of a split impulse that concerns joints, and the distance that capsules and cylinders lose by turning.
#pragma once

#include <span>

#include "systems/solver/operators/body_operator.h"
#include "systems/solver/regions/turned_axes.h"

namespace skerry {

/// Joints during the push: locked rows hold, and axes stay within their limits for push and step together. The impulses
/// of the push use a workspace that the method no longer needs.
class PushedBodies {
public:
    /// `row`: rows of ContactTable of the region.
    PushedBodies(const TurnedAxes& axes, const BodyMemory& memory, std::span<const Index> row, const BodyOperator& op);

    bool any_turns() const { return axes_.any(); }
    /// Speed at which a contact loses distance by turning bodies, at most 0 (docs/methods/rigid_bodies.md 6.2) [m/s]
    Real loss(std::size_t i, std::span<const Vec4> push_velocity) const {
        return axes_.any() ? axes_.loss(row_[i], memory_.part[i], push_velocity) : 0;
    }
    /// One sweep over the joints. Returns the size of the change [J]
    Real sweep_joints(std::span<Vec4> push_velocity) const;

private:
    AxisBounds bounds(std::size_t at, const JointLaw& law) const;

    TurnedAxes axes_;
    const BodyMemory& memory_;
    std::span<const Index> row_;
    const BodyOperator& op_;
};

}  // namespace skerry
