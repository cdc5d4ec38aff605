// Constraint law of contacts: Signorini's condition and Coulomb friction (docs/methods/contact.md).
#include "engine/world/kernels.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/collision/find_candidates.h"
#include "systems/collision/find_contacts.h"
#include "systems/collision/find_crossings.h"
#include "systems/contact/apply_surface_sets.h"
#include "systems/contact/keep_resting_contacts.h"
#include "systems/contact/match_warm_start.h"

namespace skerry {

namespace {

auto collision_inputs(const Model& m) {
    return inputs<CollisionInputs>(m.bodies, m.colliders, m.surface, m.materials, m.bvh, m.bvh_leaves, m.nodes,
                                   m.disabled_pairs, m.material_pairs);
}

void list_search(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ContactTable& c = w.scratch.contacts;
    const StepParameters& p = w.scratch.parameters;
    const auto searched =
        inputs<CollisionInputs>(m.bodies, m.colliders, m.surface, m.materials, m.bvh, m.bvh_leaves, m.nodes,
                                m.disabled_pairs, m.material_pairs, w.ranks.owner, w.ranks.rank);
    g.stage("collision/find_candidates", kernels().find_candidates, searched, value(p.collision), value(p.h),
            write(m.bvh.box), make(w.cache.search), make(w.cache.pairs));
    g.stage("collision/find_contacts", kernels().find_contacts, collision_inputs(m), value(p.collision), value(p.h),
            make(w.cache.pairs), make(w.cache.crossings), make(c));
    g.stage("contact/apply_surface_sets", apply_surface_sets, collision_inputs(m), read(m.surface_sets),
            read(m.set_of_feature), make(c),
            only_if([](const Column<std::uint32_t>& slot) { return !slot.empty(); }, value(m.surface_sets.slot)));
    const auto if_warm = only_if([](WarmStart start) { return start == WarmStart::on; }, value(p.solver.warm_start));
    g.stage("contact/match_warm_start", match_warm_start, read(c.key), read(c.normal), read(w.cache.warm_start),
            read(w.cache.resting), value(p.kick_time), write(c.impulse), if_warm);
    const auto if_frames = only_if([](const Column<Real>& mass) { return !mass.empty(); }, value(m.rigid_bodies.mass));
    g.stage("contact/hand_on_impulses", hand_on_impulses, inputs<ContactsNow>(c, m.bodies), read(w.cache.warm_start),
            value(p.kick_time), write(c.impulse), if_warm, if_frames);
    list_row_exchange(w, g);
}

void list_contact_measures(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    ContactTable& c = w.scratch.contacts;
    g.stage_with_result("contact/measure_contacts", w.scratch.findings.measures, measure_contacts, read(c),
                        read(n.inverse_mass), read(n.velocity), read(n.velocity_next),
                        inputs<RoundSpins>(n, m.bodies, m.rigid_bodies), write(c.slip), write(c.state),
                        value(w.scratch.parameters.solver.friction));
}

void list_crossings(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("collision/find_crossings", w.scratch.findings.crossings, kernels().find_crossings,
                        collision_inputs(w.model), value(p.collision), value(p.h), read(n.velocity_next),
                        read(n.push_out), make(w.cache.pairs), make(w.cache.crossings), if_possible(w));
}

void list_memory(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const auto if_found = only_if([](std::size_t count) { return count > 0; }, read(w.cache.crossings.found_count));
    g.stage("collision/use_crossings", use_crossings, make(w.cache.pairs), make(w.cache.crossings), if_found);
    ContactTable& c = w.scratch.contacts;
    const StepParameters& p = w.scratch.parameters;
    g.stage("contact/store_warm_start", store_warm_start,
            inputs<ContactsDone>(c, m.rigid_bodies, m.of_ranks.has_frames), value(p.kick_time),
            make(w.cache.warm_start), if_taken(w));
    g.stage("contact/keep_resting_contacts", keep_resting_contacts, read(c),
            inputs<RestingInputs>(w.cache.pairs, m.bodies, m.colliders), value(p.kick_time),
            make(w.scratch.resting_memory), make(w.cache.resting), if_taken(w));
}

}  // namespace

constinit const ConstraintLaw contact_law{.find = list_search,
                                          .take = list_rows_taken_back,
                                          .measure = list_contact_measures,
                                          .check = list_crossings,
                                          .remember = list_memory};

}  // namespace skerry
