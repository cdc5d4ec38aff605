// Rows of joints in a region. They are solved like contacts, but with a different law (docs/methods/joints.md 2).
#pragma once

#include <span>

#include "systems/solver/local/load_sums.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// References to the data of one joint block in the memory of a region.
struct LoadedJoint {
    LumpedContact& contact;
    RigidPart& part;
    JointLaw& law;
};

/// Fills `loaded` from `block`. `rigid` lists the rigid bodies of the region. Each body has two velocity rows, in the
/// order of the list.
void load_joint(const RegionStage& stage, const JointBlock& block, std::span<const Index> rigid,
                const LoadedJoint& loaded);

/// Sets the mobility of a mimic equation, which couples the axis velocities of two joints, from its two loaded blocks.
/// The equation is solved with `first`; the block `leader` gets mobility 0, so sweeps skip it.
void load_mimic(const LoadedJoint& first, const LoadedJoint& leader);

/// Corrects the offset of a joint by one Newton step, so that the joint holds at the end of the step. The change of the
/// offset is (predicted - remaining) / h:
/// - predicted: position error at the end of the step by the velocities of the region
/// - remaining: part of the present error that the bounded correction speed leaves to later steps
///
/// Returns the squared mass-weighted norm of the change [kg (m/s)^2, or kg m^2 (rad/s)^2 for rows of rotation]
Real correct_joint(const RegionStage& stage, const JointBlock& block, std::span<const Vec4> velocity,
                   const LoadedJoint& loaded);

/// Adds a joint block to the sums for the error scale of a region. `u` is the relative velocity at the joint without
/// impulses, in world axes [m/s or rad/s].
void add_joint(const LoadedJoint& loaded, const Vec4& u, LoadSums& sums);

}  // namespace skerry
