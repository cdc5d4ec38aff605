// Constraint law of ties: nodes of deformable bodies that are fixed to other objects (docs/methods/ties.md). While
// contact regions are solved, the contact table contains the rows of ties after the contacts.
#include "engine/world/step/seams.h"

namespace skerry {

namespace {

auto tie_inputs(const Model& m) {
    return inputs<TieInputs>(m.ties, m.bodies, m.nodes, m.rigid_bodies, m.colliders, m.any_asleep);
}

auto if_any_tie(const Model& m) {
    return only_if([](std::span<const std::uint32_t> slot) { return !slot.empty(); }, read(m.ties.slot));
}

bool prepare_tie_rows(const TieInputs& ties, const StepParameters& p, ContactTable& contacts, TieRowTable& rows,
                      CableBlockTable& blocks) {
    const TieStep step{p.h, p.kick_time, p.solver.recovery_speed, p.solver.warm_start};
    return prepare_ties(ties, step, contacts, rows, blocks);
}

Index store(const TieRowTable& rows, const BallTies& means, Real start, const StepParameters& p, TieTable& ties) {
    return store_ties(rows, means, {start + p.h, p.h, p.kick_time}, ties);
}

void list_tie_rows(WorldState& w, TaskGraph& g) {
    g.stage("contact/prepare_ties", prepare_tie_rows, tie_inputs(w.model), value(w.scratch.parameters),
            make(w.scratch.contacts), make(w.scratch.ties), make(w.scratch.cables), if_any_tie(w.model));
}

void list_taken_rows(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage_with_result("contact/take_tie_rows", w.scratch.findings.ties, take_tie_rows,
                        inputs<TieWorkInputs>(m.nodes, m.bodies, m.rigid_bodies), read(w.scratch.cables),
                        make(w.scratch.contacts), make(w.scratch.ties), if_any_tie(m));
}

void list_tie_memory(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage_with_result("contact/store_ties", w.scratch.findings.released_ties, store, read(w.scratch.ties),
                        inputs<BallTies>(w.scratch.cables, m.bodies, m.nodes), value(w.clock.time),
                        value(w.scratch.parameters), make(m.ties), if_any_tie(m), if_taken(w));
}

}  // namespace

constinit const ConstraintLaw tie_law{.find = list_tie_rows, .take = list_taken_rows, .remember = list_tie_memory};

}  // namespace skerry
