// Finds the tetrahedra that a step would turn inside out (docs/methods/time_stepping.md 4.2).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/column.h"
#include "components/element_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct InversionInputs {
    std::span<const TetrahedronNodes> tetrahedron_node;  // TetrahedronBlockTable
    std::span<const ElementLane> tetrahedron_volume;
    // above 1 if an implicit element averages over the tetrahedron (find_leeway()), else 1; empty: 1 for all
    std::span<const ElementLane> tetrahedron_leeway;
    std::span<const std::uint8_t> tetrahedron_sliver;  // empty if there are no slivers
    std::span<const Range> body_blocks;                // BodyTable
    std::span<const Real> body_frame_speed, body_travel, body_displacement;
    std::span<const Vec3> position;  // position at the start of the step [m]
    // push_out is empty if no contact pushes nodes out of an overlap [m/s]
    std::span<const Vec3> velocity_next, push_out;
    // column of BodyTable; rigid and implicit bodies are not checked; empty: no body is rigid or implicit
    std::span<const Range> body_rigid = {};

    /// `pushed`: true if a contact pushes nodes out of penetration in this step.
    static InversionInputs bind(const Binder& binder, const TetrahedronBlockTable& tetrahedron, const BodyTable& body,
                                const NodeTable& node, const bool& pushed) {
        return {.tetrahedron_node = binder.read(tetrahedron.node),
                .tetrahedron_volume = binder.read(tetrahedron.volume),
                .tetrahedron_leeway = binder.read(tetrahedron.leeway),
                .tetrahedron_sliver = binder.read(tetrahedron.sliver),
                .body_blocks = binder.read(body.tetrahedron_blocks),
                .body_frame_speed = binder.read(body.frame_speed),
                .body_travel = binder.read(body.travel),
                .body_displacement = binder.read(body.displacement),
                .position = binder.read(node.position),
                .velocity_next = binder.read(node.velocity_next),
                .push_out = binder.read_if(binder.read(pushed), node.push_out),
                .body_rigid = binder.read(body.rigid)};
    }
};

/// Tetrahedra whose volume is positive at the start of a step but not at the end of the step.
struct Inversions {
    Index count = 0;
    Index body = no_index;         // body of the first inverted tetrahedron: row of BodyTable
    Index tetrahedron = no_index;  // first tetrahedron that the step inverts: lane t % 8 of block t / 8
    // True if harmful inversions (InversionPart::is_harmful) occur in a body that had none before the step.
    bool is_first_of_body = false;
};

/// Part of a body that has to be checked for inversions: some of its blocks, and the result of the check.
struct InversionPart {
    Index body = no_index;
    Range blocks{0, 0};
    Real uninverted_until = 0;  // travel of the body up to which no tetrahedron of these blocks can invert [m]
    // `count`: number of tetrahedra that the step inverts. `tetrahedron`: the first of them.
    Index count = 0, tetrahedron = no_index;
    // True if one of the inverted tetrahedra is harmful. Slivers (tetrahedra of negligible volume) are harmless. So are
    // tetrahedra over which an implicit element averages its deformation gradient, because implicit elements never make
    // a step unstable.
    bool is_harmful = false;
};

/// Working memory of find_inversions, reused in later steps.
struct InversionMemory {
    Column<InversionPart> part;  // parts of all bodies to check, in body order
    Column<Index> job;           // first row of `part` for each job; the last entry is the number of parts
    // For each block of tetrahedra: number of checks until the next travel budget (distance without a check) is
    // computed. It is above zero only if the block has a tetrahedron so narrow that one step would use up the budget.
    Column<std::uint8_t> checks_left;
};

struct InversionBudgets {
    std::span<Real> block_uninverted_until;  // TetrahedronBlockTable
    std::span<Real> body_uninverted_until;   // BodyTable

    static InversionBudgets bind(const Binder& binder, TetrahedronBlockTable& tetrahedron, BodyTable& body) {
        return {binder.write(tetrahedron.uninverted_until), binder.write(body.uninverted_until)};
    }
};

/// Finds the tetrahedra that a step of length `h` [s] inverts. Parallel over parts of bodies.
///
/// A tetrahedron cannot invert until a corner has moved by half of its width, the least distance of two parallel planes
/// that enclose it. So each check of a block of tetrahedra writes a travel budget: the distance that the body may move
/// before the next check. Blocks with narrow tetrahedra are checked often, all others rarely. For a block too narrow
/// for a budget, only every eighth check computes a new one.
Inversions find_inversions(Executor& executor, const InversionInputs& inputs, Real h, InversionMemory& memory,
                           const InversionBudgets& budgets);

}  // namespace skerry
