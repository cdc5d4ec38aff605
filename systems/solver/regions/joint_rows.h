// Rows of joints in a region. They are treated as contacts with a different law (docs/methods/joints.md 2).
#pragma once

#include <span>

#include "systems/solver/local/load_sums.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// References to the data of one joint block in the memory of a region.
struct JointPlaceInRegion {
    LumpedContact& contact;
    RigidPart& part;
    JointLaw& law;
};

/// Fills `place` from `block`. `rigid` lists the rigid bodies of the region; each has two velocities, in this order.
void load_joint(const RegionStage& stage, const JointBlock& block, std::span<const Index> rigid,
                const JointPlaceInRegion& place);

/// One Newton step towards a joint that holds at the end of the step. Predicts the error of the block at the end of the
/// step from the velocities of the region. Adds to the offset the part of this error, divided by h, that is not left
/// for later steps. Returns this correction in the mass-weighted norm [kg (m/s)^2, or the same for rows of spins]
Real correct_joint(const RegionStage& stage, const JointBlock& block, std::span<const Vec4> velocity,
                   const JointPlaceInRegion& place);

/// Adds the joint to the sums for the error scale of a region. `u`: velocity of the rows without impulses.
void add_joint(const JointPlaceInRegion& place, const Vec4& u, LoadSums& sums);

}  // namespace skerry
