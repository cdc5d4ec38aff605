// Progress of the periodic checks of the stable steps of all bodies. The checks are done in small pieces, spread over
// many steps, so that no step takes longer than others because of a check.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Progress of the stable-step check of one body, and the results so far.
struct StepEvaluation {
    std::uint64_t piece = 0;   // number of pieces of the check that are done (pieces_of_check)
    Index broken = no_index;   // first element whose frequency bound is not finite
    Real highest = 0;          // greatest bound of the squared frequency omega^2 of an element so far [1/s^2]
    Index element = no_index;  // element with the bound `highest`; valid if `highest` is above zero
    // Limit below which bounds need not be computed exactly: value of `highest` (for bounds with frame masses: of
    // `in_frame`) when the check of the current group of blocks began [1/s^2]. All blocks of a group use the same
    // value, so the result does not depend on the order of the threads.
    Real known = 0;
    // Values for a body with frame masses, whose bound uses one rotation for the whole body (frame_masses.h).
    // - deformation: sum of V F over the elements with volume V and deformation gradient F, column by column; it yields
    //   the rotation [m^3]
    // - in_frame: greatest bound of omega^2 of an element with the frame masses so far [1/s^2]
    std::array<Real, 9> deformation{};
    Real in_frame = 0;
    Index element_in_frame = no_index;
};

/// Checks the stable steps of all bodies, one body after the other, in endless rounds. The progress is part of the
/// state, but only `steps` is hashed: rejected attempts at a step also advance the other members, which changes no
/// result.
struct StepWatch {
    /// Value of `step` for a body that is not checked in this round. Possible reasons: its shape does not change (it is
    /// asleep or unstrained), another rank checks it, or forget() was called.
    static constexpr Real not_evaluated = -1;

    std::uint64_t steps = 0;  // number of steps since the current round began
    // True in every second round. The balance of energy is checked at the end of such a round.
    bool second = false;
    Index body = 0;             // row of BodyTable whose check is in progress
    Index kept = 0;             // first row of BodyTable whose shape store_shapes has not stored in this round
    StepEvaluation evaluation;  // progress of the check of `body`
    std::uint64_t before = 0;   // number of pieces of all bodies with lower rows than `body`
    std::uint64_t target = 0;   // number of pieces, of all bodies, that must be done when the next step ends

    Column<Vec3> position;       // by node: its position in the stored shape that is checked [m]
    Column<Real> stiffness_sum;  // by node: sum of the stiffnesses of its elements (stable_step.h)
    Column<Real> step;           // by body: stable step; 0 until its check ends; or not_evaluated [s]
    // For each body: number of pieces of all bodies before it, including those of other ranks. The last entry is the
    // number of all pieces. Derived by count_pieces; empty when it must be derived again.
    Column<std::uint64_t> first_piece;

    /// Starts a new round. An unfinished round is abandoned.
    void begin_round() {
        steps = 0;
        body = kept = 0;
        evaluation = {};
        first_piece.clear();  // elements that became implicit in the last round change the numbers of pieces
    }
    /// Cancels the check of the body in row `row`, because the caller has computed its stable step, or the body has
    /// changed since its shape was stored.
    void forget(std::size_t row) {
        if (row < step.size()) step[row] = not_evaluated;
        first_piece.clear();
    }
    /// Erases the rows of removed bodies and removed nodes. `bodies`: ranges of rows of BodyTable. `nodes`: ranges of
    /// rows of NodeTable.
    void erase(std::span<const Range> bodies, std::span<const Range> nodes) {
        step.erase(bodies);
        position.erase(nodes);
        stiffness_sum.erase(nodes);
        for (const Range& rows : bodies)
            if (body >= rows.begin && body < rows.end) evaluation = {};
        body = row_without(body, bodies);
        kept = row_without(kept, bodies);
    }
};

}  // namespace skerry
