// push_out_region for a large region: the same pseudo velocities in the coloured order, by a team of workers.
#pragma once

#include "systems/solver/coloured/coloured_operator.h"
#include "systems/solver/push_out_region.h"

namespace skerry {

/// A large region with its contacts by place in the order.
struct ColouredPush {
    const ColouredOrder& order;
    std::span<const LumpedContact> contact;
    std::span<const Vec4> velocity;  // by node of the region, solved
    std::span<SweepChange> partial;  // partial_count(order) rows
};

/// As push_out_region; `gap` by row of ContactTable, `row` by number of the contact in the region.
bool push_out_coloured(Team& team, const ColouredPush& region, std::span<const Index> row, std::span<const Real> gap, Real gravity,
                       const SolverSettings& settings, Real h, const PushMemory& memory);

}  // namespace skerry
