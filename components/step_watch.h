// Progress of the periodic checks of the stable steps of all bodies. The checks are done in small parts beside the
// steps, so that no step takes longer than others because of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Check of one body: the pieces done so far and their results.
struct StepLook {
    std::uint64_t piece = 0;   // the next piece
    Index broken = no_index;   // the first element whose bound is not a number
    Real highest = 0;          // greatest bound of omega^2 so far [1/s^2]
    Index element = no_index;  // element with that bound; meaningful if `highest` is above zero
    Real known = 0;            // bound known when the current wave of blocks began [1/s^2]
    // For a body with frame masses: sum of V F, column by column [m^3], and the bound by these masses [1/s^2].
    std::array<Real, 9> deformation{};
    Real in_frame = 0;
    Index element_in_frame = no_index;
};

/// The checks go round over all bodies. This is state, but the hash needs only `steps`: the progress of a check differs
/// after a rejected try, and the next try makes up for it.
struct StepWatch {
    /// Marks a body whose check is left out: it rests or is unstrained, so that its shape does not change, or it has
    /// been checked elsewhere.
    static constexpr Real not_looked_at = -1;

    std::uint64_t steps = 0;  // steps of the current round
    bool second = false;      // whether this is the second of two rounds, after which the energies are checked
    Index body = 0;           // row of BodyTable whose check is in progress
    Index kept = 0;           // rows below this one have had their shape stored in this round
    StepLook look;
    std::uint64_t before = 0;  // pieces of the rows below `body`
    std::uint64_t target = 0;  // pieces to be done by the end of the next step

    Column<Vec3> position;       // by node: the shape to check [m]
    Column<Real> stiffness_sum;  // stiffness sum by node (stable_step.h)
    Column<Real> step;           // by body: the stable step found, or not_looked_at [s]

    /// Starts a new round, after the current one or instead of it.
    void begin_round() {
        steps = 0;
        body = kept = 0;
        look = {};
    }
    /// Drops the check of the body in this row: it has been checked elsewhere, or has changed since its shape was
    /// stored.
    void forget(std::size_t row) {
        if (row < step.size()) step[row] = not_looked_at;
    }
    /// Removes these rows of BodyTable and of NodeTable.
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
