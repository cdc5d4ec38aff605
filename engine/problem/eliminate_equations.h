// Eliminates the equations of joints, ties and rollers from the contact problem of a step.
#pragma once

#include <optional>
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

/// Constraint equations of a step apart from the contacts, with the impulses that the solve has found.
struct StepEquations {
    const JointBlockTable& joints;
    const TieRowTable& tie_rows;
    // kind of each tie (column of TieTable); empty: no ties, and `tie_rows` is ignored
    std::span<const TieKind> tie_kind;
    const CableBlockTable& cables;
    std::vector<HeldDirection> held{};
};

/// Includes joints, ties and rollers in W and q of a problem, so that a solver for contacts alone can solve it. The
/// rows (scalar equations) of joints, welds, ball ties and rollers are eliminated: with any contact impulses, these
/// rows keep the velocities that they have after the step. With the contact impulses r* and the impulses s* of all rows
/// in the step,
///
///     W' = W - C E^-1 C^T,     q' = q + G s* + C E^-1 C^T r*.
///
/// C, E and G are blocks of the Delassus operator, which maps impulses to velocity changes. C couples contacts with
/// eliminated rows, E couples eliminated rows with each other, and G couples contacts with all rows. If r* solved the
/// problem of the step, it also solves the new one. Rows of slides, of cables, and of motors, limits and passive forces
/// of joint axes are not eliminated: they keep their impulses of the step.
///
/// `contact`: for each contact of the problem, its row in `inputs`. `impulse`: r*, in the contact frames. Returns the
/// indices of the contacts that impulses can no longer move along their normals. The blocks of these contacts are set
/// to zero, and q of the other contacts includes the effect of their impulses in the step. Returns nothing if no row
/// acts on a contact.
std::optional<std::vector<Index>> eliminate_equations(const StepEquations& equations, const RegionInputs& inputs,
                                                      std::span<const Index> contact, std::span<const Vec3> impulse,
                                                      ContactProblem& problem);

}  // namespace skerry
