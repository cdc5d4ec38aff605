// Computation of the stable steps of bodies beside the other stages of steps (docs/methods/stable_step.md 6).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/node_table.h"
#include "components/step_watch.h"
#include "jobs/access.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct WatchInputs {
    ElementInputs elements;
    std::span<const Range> body_blocks;  // BodyTable
    std::span<const Real> mass;          // by node [kg]

    static WatchInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                            const MaterialTable& material, const BodyTable& body, const NodeTable& node) {
        return {.elements = ElementInputs::bind_explicit(binder, element, nodes, material),
                .body_blocks = binder.read(body.blocks),
                .mass = binder.read(node.mass)};
    }
};

/// Numbers of pieces of looks at bodies: those before the body in progress, those with a stored shape, and all.
struct WatchPieces {
    std::uint64_t before = 0, kept = 0, total = 0;
};

/// Body whose stable step is computed in a step.
struct WatchPart {
    Index body = no_index;
    std::uint64_t until = 0;  // pieces done by the end of the step
    bool whole = false;       // all pieces are done by then
    StepLook look;
};

/// Computes the pieces that are due by the end of this step, of bodies whose shape is stored. Called again for the same
/// step it does nothing. `parts` keeps its memory between steps.
void watch_stable_steps(Executor& executor, const WatchInputs& inputs, Column<WatchPart>& parts, StepWatch& watch);

}  // namespace skerry
