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

/// Changes W and q of a contact problem so that they include joints, ties and rollers, and a solver for contacts alone
/// can solve it (docs/methods/ties.md). The rows (scalar equations) are of two kinds:
/// - Joints, welds, ball ties and rollers are eliminated: with any contact impulses, these rows keep the velocities
///   that they have after the step.
/// - Slides, cables, and motors, limits and passive forces of joint axes keep their impulses of the step.
///
/// The contact impulses of the step are r*, the impulses of all rows in the step are s*. Blocks of the Delassus
/// operator, which maps impulses to velocity changes, give the change by other contact impulses r:
/// - C: changes at contacts by eliminated rows,
/// - E: changes at eliminated rows by each other,
/// - G: changes at contacts by all rows.
///
/// The impulses of the eliminated rows change by -E^-1 C^T (r - r*), which keeps the velocities of these rows. So
///
///     W' = W - C E^-1 C^T,     q' = q + G s* + C E^-1 C^T r*.
///
/// The contact velocities W' r* + q' = W r* + q + G s* are those of the step. So r* solves the new problem if it solved
/// the problem of the step.
///
/// - `contact`: for each contact of the problem, its row in `inputs`.
/// - `impulse`: r*, in the contact frames.
///
/// Returns the indices of the contacts that impulses can no longer move along their normals. Their blocks are set to
/// zero, and q of the other contacts includes the effect of their impulses in the step. Returns nothing if no row acts
/// on a contact.
std::optional<std::vector<Index>> eliminate_equations(const StepEquations& equations, const RegionInputs& inputs,
                                                      std::span<const Index> contact, std::span<const Vec3> impulse,
                                                      ContactProblem& problem);

}  // namespace skerry
