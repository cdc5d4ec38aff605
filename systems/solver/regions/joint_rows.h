// Rows of joints in a region: as contacts whose law is another (docs/methods/joints.md 2).
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// A place in the memory of a region.
struct JointPlaceInRegion {
    LumpedContact& contact;
    RigidPart& part;
    JointLaw& law;
};

/// Fills it. `rigid`: the rigid bodies of the region, two velocities each, in this order.
void load_joint(const RegionStage& stage, const JointBlock& block, std::span<const Index> rigid,
                const JointPlaceInRegion& place);

/// kg (m/s)^2, or the same of spins: changes its offset by what it would be off by at the end of the step with these
/// velocities of the region, beyond what is left for later steps: a step of Newton's to where it holds there.
Real correct_joint(const RegionStage& stage, const JointBlock& block, std::span<const Vec4> velocity,
                   const JointPlaceInRegion& place);

/// Adds it to what the error of a region is measured against. `u`: its velocity without impulses.
void add_joint(const JointPlaceInRegion& place, const Vec4& u, LoadSums& sums);

}  // namespace skerry
