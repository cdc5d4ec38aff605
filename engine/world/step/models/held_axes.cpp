// Motion model of nodes that attachments hold along single directions.
#include "engine/world/step/seams.h"
#include "systems/dynamics/motion/hold_axes.h"

namespace skerry {

namespace {

auto hold_inputs(Model& m, const StepParameters& p) {
    return inputs<AxisHoldInputs>(m.attachments, m.nodes, m.bodies, m.forced, m.any_asleep, p.gravity);
}

void list_hold(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/hold_axes", hold_axes, hold_inputs(w.model, p), value(p.h), value(p.kick),
            write(w.model.nodes.velocity_next), make(w.scratch.axis_holds));
}

void list_hold_again(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    const auto if_any = only_if([](std::span<const Mat3> held) { return !std::ranges::all_of(held, holds_completely); },
                                read(w.model.attachments.held));
    g.stage("dynamics/hold_axes_again", hold_axes_again, hold_inputs(w.model, p), value(p.h),
            write(w.model.nodes.velocity_next), write(w.model.nodes.push_out), make(w.scratch.axis_holds), if_any);
}

}  // namespace

constinit const MotionModel held_axes{.predict = list_hold, .apply = list_hold_again};

}  // namespace skerry
