// Finds the tetrahedra that the step would turn inside out (docs/methods/time_stepping.md 4.2).
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
    std::span<const ElementLane> tetrahedron_leeway;   // empty: 1
    std::span<const std::uint8_t> tetrahedron_sliver;  // empty: there are no slivers
    std::span<const Range> body_blocks;                // BodyTable
    std::span<const Real> body_frame_speed, body_travel, body_displacement;
    std::span<const Vec3> position;                 // m, at the start of the step
    std::span<const Vec3> velocity_next, push_out;  // m/s; push_out may be empty: no contact pushes
    std::span<const Range> body_rigid = {};         // BodyTable; rigid bodies are skipped; empty: there are none

    /// `pushed`: true if some contact pushes.
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

/// Tetrahedra whose volume is positive at the start of the step and not at its end.
struct Inversions {
    Index count = 0;
    Index body = no_index;         // of the first one: row of BodyTable
    Index tetrahedron = no_index;  // the first one: lane of a block of the table
    // true if one of the bodies had no inverted tetrahedron before; slivers and tetrahedra that implicit elements cover
    // do not count
    bool first = false;
};

/// Some blocks of a body that has to be checked, and the results for them.
struct InversionPart {
    Index body = no_index;
    Range blocks{0, 0};
    Real uninverted_until = 0;                // least value of the blocks [m]
    Index count = 0, tetrahedron = no_index;  // tetrahedra that the step inverts, and the first
    bool judged = false;                      // one of them is neither a sliver nor has leeway
};

/// Working memory, kept between steps.
struct InversionMemory {
    Column<InversionPart> part;  // parts of all bodies to check, in body order
    Column<Index> job;           // first row of `part` for each job, then the number of parts
    // by block of tetrahedra: checks left before the next budget is computed; above 0 only if a tetrahedron is so
    // narrow that a budget would be spent at once
    Column<std::uint8_t> looks_left;
};

struct InversionBudgets {
    std::span<Real> block_uninverted_until;  // TetrahedronBlockTable
    std::span<Real> body_uninverted_until;   // BodyTable

    static InversionBudgets bind(const Binder& binder, TetrahedronBlockTable& tetrahedron, BodyTable& body) {
        return {binder.write(tetrahedron.uninverted_until), binder.write(body.uninverted_until)};
    }
};

/// Checks tetrahedra only if their body may have moved far enough. A tetrahedron cannot invert before its corners have
/// moved by half of its width, the distance of the two nearest parallel planes around it. So slivers are checked often,
/// the rest of their body rarely. Every check of a block writes a new budget; in blocks too narrow for a budget only
/// every eighth check does. Parallel over parts of bodies.
Inversions find_inversions(Executor& executor, const InversionInputs& inputs, Real h, InversionMemory& memory,
                           const InversionBudgets& budgets);

}  // namespace skerry
