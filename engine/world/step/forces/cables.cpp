// Force element of cables: lists the cables of the step, and adds the forces of frictionless cables with a prescribed
// tension (docs/methods/cables.md).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/world/step/seams.h"
#include "systems/forces/prepare_cables.h"

namespace skerry {

namespace {

CableInputs cables_of(const Model& model) {
    return CableInputs::bind({}, model.cables, model.bodies, model.nodes, model.colliders, model.any_asleep);
}

bool any_cable(const Model& model) {
    return model.cables.size() > 0;
}

void list_cables(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("forces/prepare_cables", prepare_cables,
            inputs<CableInputs>(m.cables, m.bodies, m.nodes, m.colliders, m.any_asleep),
            inputs<CableTimes>(w.clock.time, p.h, p.kick, p.solver.recovery_speed), make(w.scratch.cables));
    const auto if_forced = only_if([](bool forced) { return forced; }, value(m.forced));
    g.stage("forces/add_cable_forces", add_cable_forces, read(w.scratch.cables), value(p.kick),
            write(m.nodes.applied_force), if_forced);
}

/// Adds the bound of a segment of the length `length` and of the greatest tension `tension` to its bodies.
void add_segment_rate(const CableInputs& cables, std::size_t point, Real tension, std::span<Real> of_body) {
    const Real length = (cables.anchor.at(point + 1) - cables.anchor.at(point)).norm();
    if (!(length > 0) || tension == 0) return;
    // A segment resists a displacement across its direction with the stiffness tension / length. With the weights w of
    // the nodes of an anchor and their masses m, w^2 / m sums to the mobility of the anchor.
    Real mobility = 0;  // [1/kg]
    for (const std::size_t end : {point, point + 1})
        cables.anchor.for_each_node(
            end, [&](std::size_t node, Real weight) { mobility += weight * weight * cables.inverse_mass[node]; });
    for (const std::size_t end : {point, point + 1})
        if (const Index body = cables.anchor.body[end]; body != no_index)
            of_body[static_cast<std::size_t>(body)] += tension / length * mobility;
}

void add_cable_rate(const Model& model, std::span<Real> of_body) {
    const CableInputs cables = cables_of(model);
    for (std::size_t c = 0; c < cables.size(); ++c) {
        const Range points = cables.points[c];
        const std::span<const TimeKey> keys = cables.keys_of(c);
        const bool known = cables.control[c] == CableControl::tension;
        for (Index p = points.begin; p + 1 < points.end; ++p) {
            const auto at = static_cast<std::size_t>(p);
            const Real last = cables.step[c] > 0 ? cables.tension[at] / cables.step[c] : 0;
            const Real most = known ? std::ranges::max_element(keys, {}, &TimeKey::value)->value : last;
            add_segment_rate(cables, at, most, of_body);
        }
    }
}

}  // namespace

constinit const ForceElement cable_forces{
    .any = any_cable, .add_forces = list_cables, .add_rate = add_cable_rate, .rate_moves = true};

}  // namespace skerry
