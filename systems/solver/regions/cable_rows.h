// Rows of cables, and of ties of the kind `ball`, in a region (docs/methods/cables.md 2). A cable has rows if its
// length is prescribed or it has friction. Each of its points has three rows like a contact, and the law of the cable
// couples the rows of all points.
#pragma once

#include <span>

#include "systems/solver/local/load_sums.h"
#include "systems/solver/operators/body_operator.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Fills the CableLaw of a cable. The points of the cable must already be loaded, from index `first` of memory.contact
/// on. `traversal`: traversal of the region. Adds the cable to the sums for the error scale.
void load_cable(const RegionStage& stage, Index cable, const BodyMemory& memory, const ThroughGroups& traversal,
                Index first, LoadSums& sums);

/// Sets the impulses of the points of a cable to those of the last step.
void take_cable_impulses(const RegionStage& stage, Index cable, const BodyMemory& memory);

/// Writes the impulses and the work of a cable. The velocities of its nodes must already be written.
void write_cable(const RegionStage& stage, Index cable, const BodyMemory& memory);

}  // namespace skerry
