// Progress of the periodic checks of the stable steps of all bodies. The checks are done in small pieces beside the
// steps, so that no step takes longer than others because of a check.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Progress of the check of one body: the number of pieces done, and the results so far.
struct StepLook {
    std::uint64_t piece = 0;   // the next piece
    Index broken = no_index;   // the first element whose bound is not finite
    Real highest = 0;          // greatest bound of the squared frequency omega^2 so far [1/s^2]
    Index element = no_index;  // element with the greatest bound; valid if `highest` is above zero
    Real known = 0;            // greatest bound at the start of the current wave of blocks [1/s^2]
    // For a body with frame masses (frame_masses.h): sum of V F over its elements of volume V, column by column [m^3],
    // and the bound of omega^2 that follows from these masses [1/s^2].
    std::array<Real, 9> deformation{};
    Real in_frame = 0;
    Index element_in_frame = no_index;
};

/// Checks all bodies in turn, round after round. The progress is part of the state, but the hash includes only `steps`:
/// after a rejected attempt at a step the progress differs, and the next attempt makes up for it.
struct StepWatch {
    /// Value of `step` for a body that is not checked in this round: it is asleep or unstrained, so that its shape does
    /// not change, or it has been checked elsewhere.
    static constexpr Real not_looked_at = -1;

    std::uint64_t steps = 0;  // number of steps of the current round
    bool second = false;      // true: the current round is the second of two; the energies are checked after it
    Index body = 0;           // row of BodyTable whose check is in progress
    Index kept = 0;           // the shapes of all bodies below this row have been stored in this round
    StepLook look;
    std::uint64_t before = 0;  // number of pieces of the bodies below row `body`
    std::uint64_t target = 0;  // number of pieces to be done by the end of the next step

    Column<Vec3> position;       // by node: position in the shape to check [m]
    Column<Real> stiffness_sum;  // by node: sum of stiffness (stable_step.h)
    Column<Real> step;           // by body: the stable step found, or not_looked_at [s]

    /// Starts a new round, after the current round or instead of it.
    void begin_round() {
        steps = 0;
        body = kept = 0;
        look = {};
    }
    /// Drops the check of the body in this row, because it has been checked elsewhere or has changed since its shape
    /// was stored.
    void forget(std::size_t row) {
        if (row < step.size()) step[row] = not_looked_at;
    }
    /// Erases the rows of removed bodies (rows of BodyTable) and nodes (rows of NodeTable).
    void erase(std::span<const Range> bodies, std::span<const Range> nodes) {
        step.erase(bodies);
        position.erase(nodes);
        stiffness_sum.erase(nodes);
        for (const Range& rows : bodies)
            if (body >= rows.begin && body < rows.end) look = {};
        body = row_without(body, bodies);
        kept = row_without(kept, bodies);
    }
};

}  // namespace skerry
