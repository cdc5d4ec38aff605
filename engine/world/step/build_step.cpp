// The step: one list of stages. Each is named folder/function. The graph derives their order from the data that they
// read and write, so the force and the contact branch run side by side (docs/step_graph.dot shows the result). The
// bind() of a struct of inputs lists the columns that it reads.
#include "engine/world/kernels.h"
#include "engine/world/step/step.h"
#include "systems/collision/find_candidates.h"
#include "systems/collision/find_contacts.h"
#include "systems/collision/find_crossings.h"
#include "systems/contact/keep_resting_contacts.h"
#include "systems/contact/match_warm_start.h"
#include "systems/contact/sum_contact_impulses.h"
#include "systems/dynamics/checks/measure_reactions.h"
#include "systems/dynamics/checks/measure_work.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
#include "systems/dynamics/elements/find_unstrained.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/joints/measure_joints.h"
#include "systems/dynamics/joints/prepare_joints.h"
#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/damp_velocity.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/dynamics/motion/update_sleep.h"
#include "systems/dynamics/rigid/move_rigid_bodies.h"
#include "systems/dynamics/stability/watch_stable_steps.h"

namespace skerry {

namespace {

/// Scripts set the motion of colliders and held nodes during this step.
void list_scripted_motion(WorldState& w, TaskGraph& g) {
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

/// Evaluates stable steps beside all other stages.
void list_watch(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/watch_stable_steps", kernels().watch_stable_steps,
            inputs<WatchInputs>(m.elements, m.element_nodes, m.materials, m.bodies, m.nodes),
            make(w.scratch.watch_parts), make(m.watch));
}

auto implicit_bodies(const Model& m) {
    return inputs<ImplicitBodies>(m.rigid_bodies, m.bodies, m.materials, m.implicit_nodes, m.nodes, m.attachments,
                                  m.any_asleep);
}

void list_force_branch(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    ElementBlockTable& e = m.elements;
    BodyTable& b = m.bodies;
    NodeBlockTable& k = m.node_blocks;
    const StepParameters& p = w.scratch.parameters;
    const auto if_unknown = only_if([](bool known) { return !known; }, value(p.forces_known));
    g.stage_with_result("dynamics/find_unstrained", w.scratch.findings.unstrained, find_unstrained,
                        inputs<UnstrainedInputs>(e, m.element_nodes, m.materials, b, n),
                        outputs<UnstrainedOutputs>(b, e), if_unknown);
    g.stage_with_result("dynamics/compute_element_forces", w.scratch.findings.relaxed, kernels().compute_element_forces,
                        inputs<ElementInputs>(e, m.element_nodes, m.materials, b, m.any_asleep), read(n.position),
                        read(n.velocity), value(p.kick), value(p.kick_over_last), read(e.rotation),
                        outputs<ElementMemory>(e), outputs<PatchForces>(m.patches, m.element_nodes), if_unknown);
    g.stage_with_result("dynamics/stiffen_clusters", w.scratch.findings.stiffened, stiffen_clusters,
                        inputs<ElementInputs>(e, m.element_nodes, m.materials), inputs<StiffenInputs>(b, n),
                        value(p.kick), outputs<PatchForces>(m.patches, m.element_nodes),
                        outputs<StiffenOutputs>(e, m.clusters), if_unknown);
    g.stage("dynamics/predict_velocity", kernels().predict_velocity,
            inputs<KickInputs>(k, m.patches, n, b, p.gravity, m.loaded, m.any_asleep), read(n.velocity), value(p.kick),
            write(n.force), write(n.velocity_next));
    g.stage("dynamics/damp_velocity", kernels().damp_velocity, inputs<DampingInputs>(k, b, m.materials, n, p.lag),
            read(n.velocity), value(p.kick), write(k.sums), write(n.velocity_next), make(w.scratch.findings.damped));
    g.stage("dynamics/kick_clusters", kernels().kick_clusters,
            inputs<ClusterKickInputs>(m.clusters, n, b, m.any_asleep), read(n.velocity), value(p.forces_known),
            make(w.scratch.cluster_kick), make(w.scratch.cluster_work), write(n.velocity_next));
    g.stage("dynamics/kick_rigid_bodies", kick_rigid_bodies,
            inputs<RigidBodies>(m.rigid_bodies, b, n, m.any_asleep, m.loaded),
            inputs<RigidHolds>(m.rigid_bodies, m.attachments), inputs<RigidForces>(n, p.gravity, m.loaded), value(p.h),
            value(p.kick), outputs<RigidKicks>(m.rigid_bodies, n));
    g.stage("dynamics/kick_implicit_bodies", kick_implicit_bodies, implicit_bodies(m),
            inputs<ImplicitLoads>(n, p.gravity, m.loaded, p.kick), inputs<ImplicitSpins>(m.rigid_bodies),
            inputs<ImplicitTimes>(p.h, p.theta, p.long_step), make(m.stiff_bodies),
            outputs<ImplicitKicks>(m.implicit_nodes, n));
}

auto collision_inputs(const Model& m) {
    return inputs<CollisionInputs>(m.bodies, m.colliders, m.surface, m.materials, m.bvh, m.bvh_leaves, m.nodes,
                                   m.disabled_pairs);
}

void list_contact_branch(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ContactTable& c = w.scratch.contacts;
    const StepParameters& p = w.scratch.parameters;
    g.stage("collision/find_candidates", kernels().find_candidates, collision_inputs(m), value(p.collision), value(p.h),
            write(m.bvh.box), make(w.cache.search), make(w.cache.pairs));
    g.stage("collision/find_contacts", kernels().find_contacts, collision_inputs(m), value(p.collision), value(p.h),
            make(w.cache.pairs), make(w.cache.crossings), make(c));
    const auto if_warm = only_if([](WarmStart start) { return start == WarmStart::on; }, value(p.solver.warm_start));
    g.stage("contact/match_warm_start", match_warm_start, read(c.key), read(c.normal), read(w.cache.warm_start),
            read(w.cache.resting), value(p.kick), write(c.impulse), if_warm);
    const auto if_frames = only_if([](const Column<Real>& mass) { return !mass.empty(); }, value(m.rigid_bodies.mass));
    g.stage("contact/hand_on_impulses", hand_on_impulses, inputs<ContactsNow>(c, m.bodies), read(w.cache.warm_start),
            value(p.kick), write(c.impulse), if_warm, if_frames);
    const auto if_any_asleep = only_if([](bool any_asleep) { return any_asleep; }, value(m.any_asleep));
    g.stage("dynamics/mark_pressed", mark_pressed, inputs<PressInputs>(c, m.bodies, p.solver.warm_start),
            make(w.scratch.pressed), if_any_asleep);
    g.stage("dynamics/prepare_joints", prepare_joints,
            inputs<JointInputs>(m.joints, m.bodies, m.rigid_bodies, m.any_asleep), value(p.kick),
            make(w.scratch.joints));
    g.stage("contact/separate_regions", separate_regions, read(c.stencil), read(m.nodes.inverse_mass),
            inputs<NodeGroups>(m.clusters, m.nodes, m.bodies, m.rigid_bodies, w.scratch.joints),
            value(p.contact_regions), make(w.scratch.separation_memory), make(w.scratch.regions), write(c.region));
    g.stage("dynamics/couple_implicit_bodies", couple_implicit_bodies, implicit_bodies(m), read(c.stencil),
            read(m.nodes.body), inputs<ImplicitTimes>(p.h, p.theta, p.long_step), make(m.stiff_bodies),
            make(w.scratch.coupling));
}

void list_solve(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    ContactTable& c = w.scratch.contacts;
    const StepParameters& p = w.scratch.parameters;
    const auto if_wanted = only_if([](bool wanted) { return wanted; }, value(p.problem_wanted));
    g.stage("world/keep_velocities", keep_velocities, read(n.velocity), read(n.velocity_next), read(n.position),
            inputs<KeptFrames>(w.model.rigid_bodies, w.model.implicit_nodes), make(w.scratch.kept_velocities),
            if_wanted);
    g.stage("solver/solve_regions", kernels().solve_regions,
            inputs<RegionInputs>(c, n, n.velocity, p.collision.gravity, w.model.clusters, w.scratch.cluster_kick,
                                 w.model.bodies, w.model.rigid_bodies, w.model.implicit_nodes, w.scratch.coupling,
                                 w.scratch.joints),
            value(p.solver), value(p.h), make(w.scratch.solver_memory), make(w.scratch.regions),
            outputs<RegionOutputs>(c, n, w.model.rigid_bodies, w.model.implicit_nodes, w.scratch.joints));
    g.stage_with_result("dynamics/measure_joints", w.scratch.findings.joints, measure_joints,
                        inputs<JointWorkInputs>(w.scratch.joints, w.model.rigid_bodies));
    g.stage_with_result("contact/measure_contacts", w.scratch.findings.measures, measure_contacts, read(c),
                        read(n.inverse_mass), read(n.velocity), read(n.velocity_next),
                        inputs<RoundSpins>(n, w.model.bodies, w.model.rigid_bodies), write(c.slip), write(c.state),
                        value(p.solver.friction));
}

/// Sums of contact and attachment forces, if requested.
void list_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ForceScratch& f = w.scratch.forces;
    const StepParameters& p = w.scratch.parameters;
    const auto if_wanted = only_if([](bool wanted) { return wanted; }, value(p.forces_wanted));
    g.stage("contact/sum_contact_impulses", sum_contact_impulses,
            inputs<ContactSumInputs>(w.scratch.contacts, m.bodies, m.nodes, m.attachments), value(p.moment_point),
            make(f.pairs), make(f.held_impulse), if_wanted);
    g.stage("dynamics/measure_reactions", measure_reactions,
            inputs<ReactionInputs>(m.attachments, m.nodes, m.bodies, m.materials, m.elements, m.element_nodes,
                                   m.rigid_bodies, f.held_impulse, f.held_velocity),
            value(p.kick), value(p.moment_point), make(f.node_impulse), make(f.reactions), if_wanted);
}

/// Deformation of implicit bodies, and its reaction on their supports.
void list_strains(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/strain_implicit_bodies", w.scratch.findings.strained, strain_implicit_bodies,
                        implicit_bodies(m), inputs<ImplicitLoads>(m.nodes, p.gravity, m.loaded, p.kick),
                        inputs<ImplicitSpins>(m.rigid_bodies), inputs<ImplicitTimes>(p.h, p.theta, p.long_step),
                        make(m.stiff_bodies), outputs<ImplicitStrains>(m.implicit_nodes, m.rigid_bodies, m.nodes),
                        make(w.scratch.strain_parts));
}

/// From here on velocity_next of a rigid body leads straight to its next position.
void list_turns(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/turn_rigid_bodies", turn_rigid_bodies,
            inputs<RigidBodies>(m.rigid_bodies, m.bodies, m.nodes, m.any_asleep, m.loaded),
            inputs<RigidHolds>(m.rigid_bodies, m.attachments), inputs<RigidImpulses>(m.rigid_bodies),
            inputs<ElasticMotion>(m.implicit_nodes, m.rigid_bodies), read(m.nodes.position),
            value(w.scratch.parameters.h), outputs<RigidTurns>(m.rigid_bodies, m.nodes));
}

/// Checks of the step.
void list_checks(WorldState& w, TaskGraph& g) {
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
    const auto if_possible =
        only_if([](const StepVerdict& verdict) { return verdict.fault == StepFault::none; }, read(found.verdict));
    g.stage_with_result("dynamics/find_inversions", found.inversions, kernels().find_inversions,
                        inputs<InversionInputs>(m.tetrahedra, b, n, pushed), value(p.h), make(w.scratch.inversions),
                        outputs<InversionBudgets>(m.tetrahedra, b), if_possible);
    const auto if_viscous = only_if([](std::span<const ElementViscousImpulse> impulse) { return !impulse.empty(); },
                                    read(m.patches.viscous_impulse));
    g.stage_with_result("dynamics/measure_viscosity", found.viscous, kernels().measure_viscosity,
                        inputs<ElementInputs>(m.elements, m.element_nodes, m.materials, b, m.any_asleep),
                        read(m.patches.blocks), read(m.patches.viscous_impulse), read(m.patches.viscous),
                        read(n.velocity), read(n.velocity_next), make(w.scratch.viscous_parts), if_viscous);
    const auto if_any = only_if([](bool loaded, std::span<const Index> held) { return loaded || !held.empty(); },
                                value(m.loaded), read(m.attachments.node));
    g.stage_with_result("dynamics/measure_work", found.external, measure_work,
                        inputs<WorkInputs>(n, m.attachments, b, m.loaded, m.any_asleep, p.gravity), value(p.h),
                        value(p.kick), make(w.scratch.work_parts), if_any);
    g.stage_with_result("collision/find_crossings", found.crossings, kernels().find_crossings, collision_inputs(m),
                        value(p.collision), value(p.h), read(n.velocity_next), read(n.push_out), make(w.cache.pairs),
                        make(w.cache.crossings), if_possible);
}

/// Commits the step when it can be trusted.
void list_commit(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    ContactTable& c = w.scratch.contacts;
    BodyTable& b = w.model.bodies;
    NodeBlockTable& k = w.model.node_blocks;
    AttachmentTable& a = w.model.attachments;
    StepFindings& found = w.scratch.findings;
    const StepParameters& p = w.scratch.parameters;
    const auto if_taken =
        only_if(can_be_taken, read(found.verdict), read(found.crossings), read(found.inversions), value(p));
    const auto if_sleepy = only_if([](const SleepSettings& sleep) { return sleep.on(); }, value(p.sleep));
    g.stage("dynamics/wake_bodies", wake_bodies, inputs<TouchInputs>(c, w.model.joints), read(w.scratch.pressed),
            read(a.body), read(a.motion), write(b.asleep), write(b.still_time), if_taken, if_sleepy);
    g.stage("dynamics/advance_positions", kernels().advance_positions,
            inputs<AdvanceInputs>(k, b, n, n.velocity_next, w.model.any_asleep), value(p.h),
            outputs<AdvanceOutputs>(n, k, w.scratch.regions.pushed), if_taken);
    RigidBodyTable& r = w.model.rigid_bodies;
    g.stage("dynamics/move_rigid_bodies", move_rigid_bodies,
            inputs<RigidBodies>(r, b, n, w.model.any_asleep, w.model.loaded), inputs<RigidImpulses>(r),
            inputs<ElasticMotion>(w.model.implicit_nodes, r), read(r.center_next), read(r.rotation_next),
            value(p.draws_late), outputs<RigidMoves>(r, n, w.model.implicit_nodes), if_taken);
    const auto if_long = only_if([](bool takes) { return takes; }, value(p.takes_long_steps));
    g.stage("dynamics/carry_long_steps", carry_long_steps, inputs<ImplicitTimes>(p.h, p.theta, p.long_step),
            read(r.body), read(b.implicit), make(w.model.stiff_bodies), write(w.model.implicit_nodes.left), if_taken,
            if_long);
    g.stage("dynamics/measure_displacement", kernels().measure_displacement, inputs<DisplacementInputs>(k, b, n),
            value(p.h), outputs<DisplacementOutputs>(n, w.cache.search.memory.rebase, b), if_taken);
    g.stage_with_result("dynamics/rest_bodies", found.rest, rest_bodies, inputs<TouchInputs>(c, w.model.joints),
                        inputs<RestInputs>(a, b, w.model.materials, n, r), value(p.sleep), value(p.h),
                        make(w.scratch.sleep_memory), outputs<RestOutputs>(b, n, r, w.model.implicit_nodes), if_taken,
                        if_sleepy);
    g.stage("dynamics/store_joints", store_joints, read(w.scratch.joints), value(p.kick),
            outputs<JointMemory>(w.model.joints), if_taken);
    g.stage("contact/store_warm_start", store_warm_start, inputs<ContactsDone>(c, w.model.rigid_bodies), value(p.kick),
            make(w.cache.warm_start), if_taken);
    g.stage("contact/keep_resting_contacts", keep_resting_contacts, read(c),
            inputs<RestingInputs>(w.cache.pairs, b, w.model.colliders), value(p.kick), make(w.scratch.resting_memory),
            make(w.cache.resting), if_taken);
}

}  // namespace

void build_step(WorldState& world) {
    list_scripted_motion(world, world.graph);
    list_watch(world, world.graph);
    list_force_branch(world, world.graph);
    list_contact_branch(world, world.graph);
    list_solve(world, world.graph);
    list_strains(world, world.graph);
    list_forces(world, world.graph);
    list_turns(world, world.graph);
    list_checks(world, world.graph);
    list_commit(world, world.graph);
    world.graph.compile();
}

}  // namespace skerry
