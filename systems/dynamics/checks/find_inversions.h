// Which tetrahedra the step would turn inside out (docs/methods/time_stepping.md 4.2).
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
    std::span<const std::uint8_t> tetrahedron_sliver;  // empty: none is one
    std::span<const Range> body_blocks;                // BodyTable
    std::span<const Real> body_frame_speed, body_travel, body_displacement;
    std::span<const Vec3> position;                 // m, at the start of the step
    std::span<const Vec3> velocity_next, push_out;  // push_out: empty: no contact pushes
    std::span<const Range> body_rigid = {};         // BodyTable; rigid bodies are not looked at; empty: none is

    /// `pushed`: some contact pushes.
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
    Index body = no_index;         // row of BodyTable, of the first
    Index tetrahedron = no_index;  // of the table: lane of a block
    // some body of them had no inverted tetrahedron before; slivers and what implicit elements cover do not count
    bool first = false;
};

/// Some blocks of a body that is due, and what was found in them.
struct InversionPart {
    Index body = no_index;
    Range blocks{0, 0};
    Real uninverted_until = 0;                // m, the least of them
    Index count = 0, tetrahedron = no_index;  // that the step turns over, and the first of them
    bool judged = false;                      // some of them neither slivers nor with leeway
};

/// Working memory, kept between steps.
struct InversionMemory {
    Column<InversionPart> part;  // of all bodies that are due, in their order
    Column<Index> job;           // first rows of `part`, for each job, and their count
    // by block of tetrahedra: looks that do without a new budget, since one is so narrow that it would be spent at once
    Column<std::uint8_t> looks_left;
};

struct InversionBudgets {
    std::span<Real> block_uninverted_until;  // TetrahedronBlockTable
    std::span<Real> body_uninverted_until;   // BodyTable

    static InversionBudgets bind(const Binder& binder, TetrahedronBlockTable& tetrahedron, BodyTable& body) {
        return {binder.write(tetrahedron.uninverted_until), binder.write(body.uninverted_until)};
    }
};

/// Looks only where the body can have come far enough: a tetrahedron is not turned over before its corners have moved
/// by half of its width, the distance of the two nearest parallel planes around it. So slivers are looked at often, the
/// rest of their body is not. Budgets are written where tetrahedra are looked at, of blocks that are too narrow for one
/// in every eighth look. Parallel over parts of bodies.
Inversions find_inversions(Executor& executor, const InversionInputs& inputs, Real h, InversionMemory& memory,
                           const InversionBudgets& budgets);

}  // namespace skerry
