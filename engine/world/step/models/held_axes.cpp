// Motion model and constraint law of nodes that attachments hold along single directions, like rollers. While contact
// regions are solved, the rows of the law are the last ones in the contact table.
#include <algorithm>

#include "engine/world/step/seams.h"
#include "systems/dynamics/motion/hold_axes.h"

namespace skerry {

namespace {

auto hold_inputs(Model& m, const StepParameters& p) {
    return inputs<AxisHoldInputs>(m.attachments, m.nodes, m.bodies, m.forced, m.any_asleep, p.gravity);
}

auto if_axes_held(const Model& m) {
    return only_if([](std::span<const Mat3> held) { return !std::ranges::all_of(held, holds_completely); },
                   read(m.attachments.held));
}

void list_hold(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/hold_axes", w.scratch.findings.held, hold_axes, hold_inputs(w.model, p), value(p.h),
                        value(p.kick_time), value(p.work_lag), write(w.model.nodes.velocity_next),
                        make(w.scratch.axis_impulse), if_axes_held(w.model));
}

void list_hold_again(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/hold_axes_again", w.scratch.findings.held_again, hold_axes_again,
                        hold_inputs(w.model, p), value(p.h), write(w.model.nodes.velocity_next),
                        write(w.model.nodes.push_out), write(w.scratch.axis_impulse), if_axes_held(w.model));
}

void list_held_rows(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/prepare_held_rows", prepare_held_rows, hold_inputs(w.model, p), read(w.scratch.cables),
            value(p.h), make(w.scratch.contacts), make(w.scratch.held_rows), if_axes_held(w.model));
}

void list_taken_rows_of_axes(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/take_held_rows", w.scratch.findings.held_rows, take_held_rows,
                        hold_inputs(w.model, p), read(w.model.nodes.velocity_next), make(w.scratch.contacts),
                        read(w.scratch.held_rows), write(w.scratch.axis_impulse), if_axes_held(w.model));
}

}  // namespace

constinit const MotionModel held_axes{.predict = list_hold, .apply = list_hold_again};
constinit const ConstraintLaw held_axes_law{.find = list_held_rows, .take = list_taken_rows_of_axes};

}  // namespace skerry
