// Loss of distance by the rotation of capsules and cylinders within the step (docs/methods/rigid_bodies.md 6.2).
#pragma once

#include <algorithm>
#include <span>

#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Contacts are solved for straight motion of their points. Points on the axis of a capsule or the surface of a
/// cylinder deviate from it: a spinning capsule that is pressed turns its ends further towards the touched surface.
/// This loss in each step would use up the contact distance.
class TurnedAxes {
public:
    /// `rigid`: the rigid bodies of the region. `velocity`: solved, two per body in this order. The impulses on them
    /// must be written to `stage.out` already.
    TurnedAxes(const RegionStage& stage, std::span<const Index> rigid, std::span<const Vec4> velocity)
        : stage_(stage), velocity_(velocity), any_(std::ranges::any_of(rigid, [&](Index r) {
              return stage.inputs.rigid.is_capsule(r) || stage.inputs.rigid.is_cylinder(r);
          })) {}

    /// True if the region has a capsule or a cylinder.
    bool any() const { return any_; }
    /// Speed along the normal at which the contact loses distance by rotation, beyond the approach by the velocities
    /// and pseudo velocities. At most 0; 0 below rounding [m/s]
    Real loss(Index row, const RigidPart& part, std::span<const Vec4> push) const;

private:
    const RegionStage& stage_;
    std::span<const Vec4> velocity_;
    bool any_;
};

}  // namespace skerry
