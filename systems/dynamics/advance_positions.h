// The drift; commits the step.
#pragma once

#include <cstdint>
#include <span>

#include "components/options.h"
#include "components/types.h"
#include "jobs/executor.h"

namespace skerry {

struct AdvanceInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const std::uint8_t> body_asleep = {};             // BodyTable; empty: none
    std::span<const Vec3> velocity_next;                        // m/s
    std::span<const Vec3> drift_origin;                         // m
};

struct AdvanceOutputs {
    std::span<Vec3> push_out;  // m/s; empty: no contact pushes
    std::span<Vec3> position;
    std::span<Vec3> velocity;
    std::span<Real> block_drift_squared;  // m^2
};

/// position += h (velocity_next + push_out); velocity = velocity_next; push_out = 0. Forward Euler (literal) drifts with the velocity before
/// the step instead. Nodes at rest are passed over. In the same pass, while positions are at hand: how far the nodes of each block are from
/// their drift origins, for measure_drift. Parallel over node blocks.
void advance_positions(Executor& executor, const AdvanceInputs& nodes, Real h, Integrator integrator, const AdvanceOutputs& out);

}  // namespace skerry
