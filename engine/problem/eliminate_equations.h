// Eliminates the equations of joints, ties and rollers from the contact problem of a step.
#pragma once

#include <span>
#include <vector>

#include "components/cable_table.h"
#include "components/joint_table.h"
#include "components/tie_table.h"
#include "skerry/problem.h"
#include "systems/solver/inputs/region_inputs.h"

namespace skerry {

/// A direction in which an attachment holds a node (a roller).
struct HeldDirection {
    Index node;
    Vec3 direction;
};

/// Rows of a step that are not contacts, with the impulses that the solve has found.
struct StepEquations {
    const JointBlockTable& joints;
    const TieRowTable& tie_rows;
    std::span<const TieKind> tie_kind;  // column of TieTable; empty: `tie_rows` is out of date
    const CableBlockTable& cables;      // solved cables, and ties of the kind `ball`
    std::vector<HeldDirection> held{};
};

/// Replaces W and q of the problem by those of contacts between bodies that joints, welds, balls and rollers connect.
/// Let C be the block of the Delassus operator between contacts and these rows, E the block between the rows, r* and s*
/// the impulses of contacts and of all rows in the step, and G the block between contacts and all rows. Then
///
///     W' = W - C E^-1 C^T,     q' = q + G s* + C E^-1 C^T r*,
///
/// so that the velocities of the rows stay those of the step, and r* solves the new problem if it solved the problem of
/// the step. Slides, cables, and motors, limits and passive forces of joint axes keep their impulses of the step.
/// `contact`: row of each contact of the problem in `inputs`. `impulse`: r*, in the contact frames. Returns true if there
/// was a row that acts on a contact.
bool eliminate_equations(const StepEquations& equations, const RegionInputs& inputs, std::span<const Index> contact,
                         std::span<const Vec3> impulse, ContactProblem& problem);

}  // namespace skerry
