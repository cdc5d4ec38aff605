// How far the looks at the stable steps of all bodies have come. They are taken in small parts beside the steps, so
// that no step takes longer than others for them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// A look at one body: the pieces of it that are done, and what they found.
struct StepLook {
    std::uint64_t piece = 0;   // the next one
    Index broken = no_index;   // the first element whose bound is no number
    Real highest = 0;          // greatest bound of omega^2 so far [1/s^2]
    Index element = no_index;  // element with that bound; meaningful if `highest` is above zero
    Real known = 0;            // 1/s^2, the bound that was known when the present wave of blocks began
    // Of a body that has masses in its frame: sum of V F, m^3, column by column, and 1/s^2, the bound by them
    std::array<Real, 9> deformation{};
    Real in_frame = 0;
    Index element_in_frame = no_index;
};

/// The looks go round over all bodies. State, of which the hash needs only the steps: what is done of a look before and
/// after a try that is given up differs, but is made up for by the next one.
struct StepWatch {
    /// Of bodies that rest or are unstrained, whose shape does not change, and of those that somebody else has looked
    /// at.
    static constexpr Real not_looked_at = -1;

    std::uint64_t steps = 0;  // of the present round
    bool second = false;      // of two rounds, after which the energies are looked at
    Index body = 0;           // row of BodyTable: whose look is under way
    Index kept = 0;           // rows below it have had their shape kept in this round
    StepLook look;
    std::uint64_t before = 0;  // pieces of the rows below `body`
    std::uint64_t target = 0;  // pieces to be done by the end of the next step

    Column<Vec3> position;       // m, by node: the shape that is looked at
    Column<Real> stiffness_sum;  // by node, of stable_step.h
    Column<Real> step;           // s, by body: what was found, or not_looked_at

    /// A new round, after this one or instead of it.
    void begin_round() {
        steps = 0;
        body = kept = 0;
        look = {};
    }
    /// Somebody else has looked at the body in this row, or it has changed since its shape was kept.
    void forget(std::size_t row) {
        if (row < step.size()) step[row] = not_looked_at;
    }
    /// These rows of BodyTable and of NodeTable are gone.
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
