// What the turn of capsules and cylinders in the step takes of their distances (docs/methods/rigid_bodies.md 6.2).
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Places on the axes of the capsules in a region, and on the surfaces of cylinders, come beside the straight way on
/// which contacts are solved: a capsule that spins while it is pressed turns its ends on, against what they touch. A
/// loss of each step, it would use up the contact distance.
class TurnedAxes {
public:
    /// `rigid`: the rigid bodies of the region, two velocities each in this order: `velocity`, solved. What contacts
    /// gave them has been written to `stage.out`.
    TurnedAxes(const RegionStage& stage, std::span<const Index> rigid, std::span<const Vec4> velocity)
        : stage_(stage), velocity_(velocity), any_(std::ranges::any_of(rigid, [&](Index r) {
              return stage.inputs.rigid.is_capsule(r) || stage.inputs.rigid.is_cylinder(r);
          })) {}

    /// Whether there are any.
    bool any() const { return any_; }
    /// m/s along the normal, not above 0: how much nearer a contact of this row comes by the turn than by the
    /// velocities and those of the push, over the step; 0 below rounding.
    Real loss(Index row, const RigidPart& part, std::span<const Vec4> push) const;

private:
    const RegionStage& stage_;
    std::span<const Vec4> velocity_;
    bool any_;
};

}  // namespace skerry
