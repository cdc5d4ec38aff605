// The step on one page: a list of stages in phases. From the data that the stages read and write, the task graph
// derives their order (docs/figures/step_graph.svg). Independent stages run in parallel.
//
// The name of a stage has the form folder/function. The function bind() of an input struct lists the columns that the
// stage reads.
#include "engine/world/step/step.h"

#include "engine/world/kernels.h"
#include "engine/world/ranks/hold/ghosts.h"
#include "engine/world/step/seams.h"
#include "systems/contact/prepare_ties.h"
#include "systems/contact/separate_regions.h"
#include "systems/contact/sum_contact_impulses.h"
#include "systems/dynamics/checks/measure_reactions.h"
#include "systems/dynamics/checks/measure_work.h"
#include "systems/dynamics/joints/prepare_joints.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/dynamics/motion/update_sleep.h"
#include "systems/dynamics/stability/watch_stable_steps.h"
#include "systems/forces/add_nodal_loads.h"

namespace skerry {

namespace {

void move_as_scripted(WorldState&, TaskGraph&);
void watch_stable_steps_beside(WorldState&, TaskGraph&);
void separate(WorldState&, TaskGraph&);
void solve(WorldState&, TaskGraph&);
void measure_forces(WorldState&, TaskGraph&);
void check_end(WorldState&, TaskGraph&);
void wake(WorldState&, TaskGraph&);
void measure_travel(WorldState&, TaskGraph&);
void put_to_rest(WorldState&, TaskGraph&);
void keep_forces(WorldState&, TaskGraph&);

template <auto stages>
void of_forces(WorldState& world, TaskGraph& graph) {
    for (const ForceElement* element : force_elements)
        if (element->*stages) (element->*stages)(world, graph);
}
template <auto stages>
void of_models(WorldState& world, TaskGraph& graph) {
    for (const MotionModel* model : motion_models)
        if (model->*stages) (model->*stages)(world, graph);
}
template <auto stages>
void of_laws(WorldState& world, TaskGraph& graph) {
    for (const ConstraintLaw* law : constraint_laws)
        if (law->*stages) (law->*stages)(world, graph);
}

}  // namespace

void build_step(WorldState& w) {
    TaskGraph& g = w.graph;
    g.begin_phase("Move colliders and held nodes");
    move_as_scripted(w, g);
    g.begin_phase("Watch stable steps");
    watch_stable_steps_beside(w, g);
    g.begin_phase("Predict velocities without contacts");
    of_forces<&ForceElement::add_forces>(w, g);
    of_models<&MotionModel::add_forces>(w, g);
    of_models<&MotionModel::predict>(w, g);
    list_led_ghosts(w, g);
    g.begin_phase("Find contacts and joint rows");
    of_laws<&ConstraintLaw::find>(w, g);
    g.begin_phase("Separate contact regions");
    separate(w, g);
    of_models<&MotionModel::couple>(w, g);
    g.begin_phase("Solve regions as concurrent jobs");
    solve(w, g);
    for (std::size_t i = constraint_laws.size(); i-- > 0;)
        if (constraint_laws[i]->take) constraint_laws[i]->take(w, g);
    of_laws<&ConstraintLaw::measure>(w, g);
    g.begin_phase("Apply impulses");
    of_models<&MotionModel::apply>(w, g);
    measure_forces(w, g);
    of_models<&MotionModel::find_pose>(w, g);
    g.begin_phase("Check the step");
    check_end(w, g);
    of_models<&MotionModel::check>(w, g);
    of_laws<&ConstraintLaw::check>(w, g);
    list_ghost_watch(w, g);
    list_wakes(w, g);
    list_reduction(w, g);
    g.begin_phase("Joined integration, if all checks hold");
    wake(w, g);
    of_models<&MotionModel::integrate>(w, g);
    g.begin_phase("Remember for the next step");
    measure_travel(w, g);
    list_ghost_paths(w, g);
    put_to_rest(w, g);
    keep_forces(w, g);
    of_laws<&ConstraintLaw::remember>(w, g);
    g.compile();
}

void list_step_again(WorldState& w) {
    const CrossingTable& crossings = w.cache.crossings;
    w.ranks.channel.ranks = w.ranks.ranks;
    w.ranks.share = {
        .balance = {}, .tested = crossings.tested, .hits = crossings.hits, .let_through = crossings.let_through};
    w.graph = TaskGraph();
    w.graph.track(&w, sizeof w, name_of_column);
    build_step(w);
}

namespace {

/// Lists the stages that set the motion of colliders and held nodes in this step, according to their scripts.
void move_as_scripted(WorldState& w, TaskGraph& g) {
    ColliderTable& c = w.model.colliders;
    AttachmentTable& a = w.model.attachments;
    NodeTable& n = w.model.nodes;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/move_colliders", move_colliders, inputs<ColliderMotionInputs>(c), value(w.clock.time), value(p.h),
            write(c.motion));
    g.stage("dynamics/move_attachments", move_colliders, inputs<ColliderMotionInputs>(a), value(w.clock.time),
            value(p.h), write(a.motion));
    g.stage("dynamics/drive_nodes", drive_nodes, inputs<NodeMotionInputs>(a), value(p.h), read(n.position),
            write(n.velocity));
}

/// Lists the stage that evaluates stable steps, for shapes that store_shapes has copied. The stage therefore runs in
/// parallel with all other stages.
void watch_stable_steps_beside(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/watch_stable_steps", kernels().watch_stable_steps,
            inputs<WatchInputs>(m.elements, m.element_nodes, m.materials, m.bodies, m.nodes),
            make(w.scratch.watch_parts), make(m.watch));
}

/// Lists the stages that divide contacts into regions, which are solved independently. Two contacts belong to the same
/// region if their impulses change the motion of common degrees of freedom, directly or through other contacts. The
/// first stages mark bodies that must be awake.
void separate(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ContactTable& c = w.scratch.contacts;
    const StepParameters& p = w.scratch.parameters;
    const auto if_any_asleep = only_if([](bool any_asleep) { return any_asleep; }, value(m.any_asleep));
    g.stage("dynamics/mark_pressed", mark_pressed, inputs<PressInputs>(c, m.bodies, p.solver.warm_start),
            make(w.scratch.pressed), if_any_asleep);
    g.stage("dynamics/mark_driven", mark_driven, inputs<JointInputs>(m.joints, m.bodies, m.rigid_bodies, m.any_asleep),
            value(w.clock.time), value(p.h), write(w.scratch.driven), if_sleepy(w));
    g.stage("contact/mark_led", mark_led,
            inputs<TieInputs>(m.ties, m.bodies, m.nodes, m.rigid_bodies, m.colliders, m.any_asleep),
            write(w.scratch.driven), if_sleepy(w));
    of_forces<&ForceElement::mark_driven>(w, g);
    g.stage("contact/separate_regions", separate_regions, read(c.stencil), read(m.nodes.inverse_mass),
            inputs<NodeGroups>(m.clusters, m.nodes, m.bodies, m.rigid_bodies, w.scratch.joints, w.scratch.cables,
                               w.scratch.rank_regions.solved_elsewhere),
            value(p.contact_regions), make(w.scratch.separation_memory), make(w.scratch.regions), write(c.region));
}

void solve(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    StepScratch& s = w.scratch;
    const StepParameters& p = s.parameters;
    const auto if_wanted = only_if([](bool wanted) { return wanted; }, value(p.problem_wanted));
    g.stage("world/keep_velocities", keep_velocities, read(n.velocity), read(n.velocity_next), read(n.position),
            inputs<KeptFrames>(m.rigid_bodies, m.implicit_nodes), make(s.kept_velocities), if_wanted);
    g.stage("solver/solve_regions", kernels().solve_regions,
            inputs<RegionInputs>(s.contacts, n, n.velocity, p.collision.gravity, m.clusters, s.cluster_kick, m.bodies,
                                 m.rigid_bodies, m.implicit_nodes, s.coupling, s.joints, s.cables, m.surface_sets),
            value(p.solver), value(p.h), make(s.solver_memory), make(s.regions),
            outputs<RegionOutputs>(s.contacts, n, m.rigid_bodies, m.implicit_nodes, s.joints, s.cables));
    list_result_exchange(w, g);
}

/// Lists the stages that sum contact and attachment forces, if a user requested them.
void measure_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ForceScratch& f = w.scratch.forces;
    const StepParameters& p = w.scratch.parameters;
    const auto if_wanted = only_if([](bool wanted) { return wanted; }, value(p.forces_wanted));
    g.stage("contact/sum_contact_impulses", sum_contact_impulses,
            inputs<ContactSumInputs>(w.scratch.contacts, m.bodies, m.nodes, m.attachments), value(p.moment_point),
            make(f.pairs), make(f.held_impulse), if_wanted);
    g.stage("dynamics/measure_reactions", measure_reactions,
            inputs<ReactionInputs>(m.attachments, m.nodes, m.bodies, m.materials, m.elements, m.element_nodes,
                                   m.rigid_bodies, w.scratch.axis_impulse, f.held_impulse, f.held_velocity),
            value(p.kick_time), value(p.moment_point), make(f.node_impulse), make(f.reactions), if_wanted);
}

/// Lists the checks that all motion models share: velocities are finite, and no element deforms too much in one step.
/// Also lists the stages that measure external work and the work of force elements.
void check_end(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    BodyTable& b = m.bodies;
    NodeBlockTable& k = m.node_blocks;
    const bool& pushed = w.scratch.regions.pushed;
    StepFindings& found = w.scratch.findings;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/check_state", found.verdict, kernels().check_state,
                        inputs<CheckInputs>(k, b, n, m.tetrahedra, m.elements, m.element_nodes, pushed), value(p.h),
                        value(p.longest), value(p.max_strain_step), outputs<SpeedOutputs>(k, b),
                        make(w.scratch.beside_fast));
    const auto if_any = only_if([](bool forced, std::span<const Index> held) { return forced || !held.empty(); },
                                value(m.forced), read(m.attachments.node));
    g.stage_with_result("dynamics/measure_work", found.external, measure_work,
                        inputs<WorkInputs>(n, m.attachments, b, m.rigid_bodies, m.forced, m.any_asleep, p.gravity),
                        value(p.h), value(p.kick_time), value(p.work_lag), make(w.scratch.work_parts), if_any);
    of_forces<&ForceElement::measure>(w, g);
}

void wake(WorldState& w, TaskGraph& g) {
    AttachmentTable& a = w.model.attachments;
    BodyTable& b = w.model.bodies;
    list_joined_wakes(w, g);
    g.stage("dynamics/wake_bodies", wake_bodies, inputs<TouchInputs>(w.scratch.contacts, w.model.links),
            read(w.scratch.pressed), read(w.scratch.driven), read(a.body), read(a.motion), write(b.asleep),
            write(b.still_time), if_taken(w), if_sleepy(w));
}

/// Lists the stage that measures how far the nodes of bodies have moved. With these distances the next step decides for
/// which objects to search contact candidates again.
void measure_travel(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    BodyTable& b = w.model.bodies;
    g.stage("dynamics/measure_displacement", kernels().measure_displacement,
            inputs<DisplacementInputs>(w.model.node_blocks, b, n), value(w.scratch.parameters.h),
            outputs<DisplacementOutputs>(n, w.cache.search.memory.rebase, b), if_taken(w));
}

void keep_forces(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    const auto if_forced = only_if([](bool forced) { return forced; }, value(w.model.forced));
    g.stage("forces/keep_applied_forces", keep_applied_forces, read(n.applied_force), write(n.applied_before),
            if_taken(w), if_forced);
    of_forces<&ForceElement::remember>(w, g);
}

void put_to_rest(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    RigidBodyTable& r = m.rigid_bodies;
    const StepParameters& p = w.scratch.parameters;
    const auto bodies = inputs<RestInputs>(m.attachments, m.bodies, m.materials, n, r, w.scratch.driven);
    const auto state = outputs<RestOutputs>(m.bodies, n, r, m.implicit_nodes);
    g.stage("dynamics/find_still_sets", find_still_sets, inputs<TouchInputs>(w.scratch.contacts, m.links), bodies,
            value(p.sleep), value(p.h), make(w.scratch.sleep_memory), state, if_taken(w), if_sleepy(w));
    list_joined_sets(w, g);
    g.stage_with_result("dynamics/rest_bodies", w.scratch.findings.rest, rest_bodies, bodies,
                        make(w.scratch.sleep_memory), state, if_taken(w), if_sleepy(w));
}

}  // namespace

}  // namespace skerry
