// Loads a large region in its coloured order, with a team of workers.
#pragma once

#include <span>

#include "systems/solver/coloured/order_region.h"

namespace skerry {

/// What a region's contacts and velocities are copied from.
struct LoadSource {
    const RegionInputs& inputs;
    std::span<const Vec3> velocity_next;  // by row of NodeTable, predicted
    const SolverSettings& settings;
    Real h;  // s
};

/// Writes contacts by place in the order, velocities by node, and zero impulses. `row`: of the region's contacts.
LoadSums load_coloured(const LoadSource& source, std::span<const Index> row, Team& team, ColouredRegion& region,
                       std::span<LumpedContact> contact, std::span<Vec4> impulse, std::span<Vec4> velocity);

}  // namespace skerry
