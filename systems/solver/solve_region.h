// One region of the step: load, start, sweep, finish. Small regions are swept side by side in between (lanes/).
#pragma once

#include <algorithm>
#include <span>

#include "components/region_table.h"
#include "systems/solver/solver_memory.h"

namespace skerry {

/// What all regions of a step share.
struct RegionStage {
    const RegionInputs& inputs;
    const SolverSettings& settings;
    Real h;  // s
    const RegionOutputs& out;
    SolverMemory::Data& memory;
};

struct RegionOutcome {
    Index iterations = 0;
    Real error = 0;
    RegionStatus status = RegionStatus::converged;
    RegionShortcut shortcut = shortcut_none;
    Index frozen = 0;
    Real dissipated = 0;  // J
};

/// The region's part of the memory, and what loading it has shown.
struct LoadedRegion {
    std::span<const Index> row;  // of its contacts
    Index base = 0;              // place of the first in the memory by contact
    LumpedOperator::Memory memory;
    Real scale = 0;            // sqrt(J), of e_nat
    bool separate = true;      // no contact closes: zero impulses solve it
    bool frictionless = true;  // no contact has friction
    bool one_friction = true;  // every contact has one coefficient
};

/// Copies contacts and moving nodes side by side; `base` is the place of the first contact in the memory by contact. Impulses are zero.
LoadedRegion load_region(const RegionStage& stage, std::span<const Index> row, Index base);

/// The impulse to start a contact from, given that of the last step: rows without friction move along the normal alone.
inline Vec4 warm_impulse(const LumpedContact& contact, const Vec3& last) {
    const Vec4 start = padded(last);
    return contact.friction.stick == 0 ? Vec4(contact.normal.dot(start) * contact.normal) : start;
}

/// J, taken out by a contact whose impulse and velocities are written (methods.md 4.3).
Real dissipated_by(const RegionStage& stage, Index row);

/// Takes the warm start unless zero is nearer. Returns true, with the outcome, when nothing is left to do.
bool start_region(const RegionStage& stage, LoadedRegion& region, RegionOutcome& outcome);

/// The method of the settings on its own, from the present impulse.
RegionOutcome sweep_region(const RegionStage& stage, LoadedRegion& region);

/// Writes impulses and velocities, pushes out, and notes what was dissipated.
void finish_region(const RegionStage& stage, const LoadedRegion& region, RegionOutcome& outcome);

/// Closed form of a region of one contact: one contact step from zero.
RegionOutcome solve_single(const RegionStage& stage, Index row);

/// A warm start within the tolerance needs no sweep: true, with the outcome. One that is so far off that zero is nearer gives way to zero.
template <ContactOperator Op>
bool start_from_warm_impulse(Op& op, const SolverSettings& settings, RegionOutcome& outcome) {
    const Real error = op.error();
    if (error <= settings.tolerance && settings.certify_warm_start) {
        outcome = {.error = error, .status = RegionStatus::certified, .shortcut = shortcut_certified};
        return true;
    }
    constexpr Real suspicious = 0.5;  // a start from zero has an error of about 1
    if (error <= suspicious) return false;
    // workspace 0 keeps the warm start while zero is looked at
    BestIterate<Op> better(op);
    better.offer(error);
    std::ranges::fill(op.impulse(), Vec4::Zero());
    op.refresh();
    if (error < op.error()) better.restore();
    return false;
}

}  // namespace skerry
