// Computes the stable steps of bodies alongside the other stages of a step (docs/methods/stable_step.md 6).
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

/// Part of a stable-step check of one body that this time step does. A check is divided into pieces (stable_step.h),
/// which are spread over several steps. `evaluation`: result of the pieces done so far.
struct WatchPart {
    Index body = no_index;
    std::uint64_t until = 0;  // number of pieces done by the end of the step
    bool whole = false;       // true if all pieces are done by the end of the step
    StepEvaluation evaluation;
};

/// Does the part of the stable-step checks that is due in this step: the pieces (see WatchPart) that must be done by
/// its end. A check of a body uses the shape of the body that `watch` stores. A second call for the same step does
/// nothing. `parts` is work memory that is reused between steps.
void watch_stable_steps(Executor& executor, const WatchInputs& inputs, Column<WatchPart>& parts, StepWatch& watch);

}  // namespace skerry
