// The step: one list of stages. Each is named folder/function; the graph takes the order from what they read and write, so the force and
// the contact branch run side by side (docs/step_graph.dot shows the result).
#include "engine/world/world_state.h"
#include "systems/collision/find_candidates.h"
#include "systems/collision/find_contacts.h"
#include "systems/collision/find_crossings.h"
#include "systems/contact/match_warm_start.h"
#include "systems/dynamics/advance_positions.h"
#include "systems/dynamics/damp_velocity.h"
#include "systems/dynamics/measure_drift.h"
#include "systems/dynamics/measure_work.h"
#include "systems/dynamics/move_colliders.h"
#include "systems/dynamics/predict_velocity.h"
#include "systems/dynamics/update_sleep.h"

namespace skerry {

namespace {

/// Scripts give colliders and held nodes their motion during this step.
void list_scripted_motion(WorldState& w, TaskGraph& g) {
    ColliderTable& c = w.colliders;
    AttachmentTable& a = w.attachments;
    NodeTable& n = w.nodes;
    g.stage("dynamics/move_colliders", move_colliders,
            bundle(
                [&c] {
                    return ColliderMotionInputs{c.script, c.keyframe, c.initial};
                },
                reads(c.script, c.keyframe, c.initial)),
            value(w.step.time), value(w.step.h), write(c.motion));
    g.stage("dynamics/move_attachments", move_colliders,
            bundle(
                [&a] {
                    return ColliderMotionInputs{a.script, a.keyframe, a.initial};
                },
                reads(a.script, a.keyframe, a.initial)),
            value(w.step.time), value(w.step.h), write(a.motion));
    g.stage("dynamics/drive_nodes", drive_nodes,
            bundle(
                [&a] {
                    return NodeMotionInputs{a.motion, a.nodes, a.node, a.anchor};
                },
                reads(a.motion, a.nodes, a.node, a.anchor)),
            value(w.step.h), read(n.position), write(n.velocity));
}

/// What velocities are behind positions by at the kick, s: leapfrog has drifted by half a step, symplectic Euler is the same half a step on.
Real velocity_lag(const WorldState& w) {
    return w.settings.integrator == Integrator::literal ? 0 : w.step.h / 2;
}

void list_force_branch(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.nodes;
    ElementBlockTable& e = w.elements;
    BodyTable& b = w.bodies;
    NodeBlockTable& k = w.node_blocks;
    g.stage("dynamics/compute_element_forces", compute_element_forces,
            bundle([&w] { return w.element_inputs(); },
                   reads(e.node, e.inverse_rest, e.volume, e.material, w.materials, e.level, e.body, e.viscous_time, b.level, b.asleep)),
            read(n.position), read(n.velocity), read(e.rotation), write(e.rotation_next), write(e.force));
    g.stage("dynamics/predict_velocity", predict_velocity,
            bundle(
                [&w, &n, &b, &e, &k] {
                    return KickInputs{k.begin, k.end,          k.body,         w.corners.view(), e.force,        {b.due, n.levels, e.level},
                                      n.mass,  n.inverse_mass, w.step.gravity, w.loads(),        b.pinned_count, w.resting_bodies()};
                },
                reads(k.begin, k.end, k.body, w.corners, e.force, b.due, n.levels, e.level, n.mass, n.inverse_mass, n.load, b.pinned_count,
                      b.asleep)),
            read(n.velocity), value(w.step.h), write(n.force), write(n.velocity_next));
    g.stage("dynamics/damp_velocity", damp_velocity,
            bundle(
                [&w, &n, &b, &k] {
                    return DampingInputs{
                        k.begin,    k.end,  k.body,         b.node_blocks,  b.material, b.pinned_count, w.materials.damping,
                        n.position, n.mass, n.inverse_mass, velocity_lag(w)};
                },
                reads(k.begin, k.end, k.body, b.node_blocks, b.material, b.pinned_count, w.materials, n.position, n.mass, n.inverse_mass,
                      w.step.h, w.settings.integrator)),
            read(n.velocity), value(w.step.h), write(k.sums), write(n.velocity_next), make(w.step.damped));
}

auto collision_inputs(WorldState& w) {
    NodeTable& n = w.nodes;
    return bundle(
        [&w, &n] {
            return CollisionInputs{w.bodies,   w.colliders,           w.surface,  n.inverse_mass, w.materials.surface,
                                   w.bvh.node, w.bvh_leaves.triangle, n.position, n.velocity,     n.rest_position};
        },
        reads(w.bodies, w.colliders, w.surface, n.inverse_mass, w.materials, w.bvh.node, w.bvh_leaves.triangle, n.position, n.velocity,
              n.rest_position));
}

void list_contact_branch(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.nodes;
    ContactTable& c = w.contacts;
    const auto inputs = collision_inputs(w);
    g.stage("collision/find_candidates", find_candidates, inputs, value(w.step.collision), value(w.step.h), write(w.bvh.box),
            write(w.bvh_leaves.box), make(w.search), make(w.pairs));
    g.stage("collision/find_contacts", find_contacts, inputs, value(w.step.collision), value(w.step.h), make(w.pairs), make(w.crossings),
            make(c));
    g.stage("contact/match_warm_start", match_warm_start, read(c.key), read(c.normal), read(w.warm_start), value(w.step.h),
            write(c.impulse), only_if([&w] { return w.step.solver.warm_start == WarmStart::on; }, reads(w.step.solver)));
    g.stage("dynamics/mark_pressed", mark_pressed, read(c.first_body), read(c.second_body),
            bundle(
                [&w, &c] {
                    return w.step.solver.warm_start == WarmStart::on ? std::span<const Vec3>(c.impulse.span()) : std::span<const Vec3>();
                },
                reads(c.impulse, w.step.solver)),
            read(w.bodies.asleep), make(w.pressed), only_if([&w] { return w.any_asleep; }, reads(w.any_asleep)));
    g.stage("contact/separate_regions", separate_regions, read(c.stencil), read(n.inverse_mass), value(w.step.contact_regions),
            make(w.union_find), make(w.regions), write(c.region));
}

void list_solve(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.nodes;
    ContactTable& c = w.contacts;
    g.stage("world/keep_velocities", keep_velocities, read(n.velocity), read(n.velocity_next), make(w.kept_velocities),
            only_if([&w] { return w.problem_watch.wants(w.counters.steps + 1); }, reads(w.problem_watch)));
    g.stage("solver/solve_regions", solve_regions,
            bundle([&w, &n] { return w.region_inputs(n.velocity); },
                   reads(c.key, c.stencil, c.normal, c.gap, c.surface_velocity, c.static_friction, c.dynamic_friction, c.restitution,
                         n.inverse_mass, n.velocity)),
            value(w.step.solver), value(w.step.h), make(w.solver_memory), make(w.regions),
            bundle(
                [&n, &c] {
                    return RegionOutputs{c.impulse, n.velocity_next, n.push_out};
                },
                writes(c.impulse, n.velocity_next, n.push_out)));
    g.stage_with_result("contact/measure_contacts", w.step.measures, measure_contacts, read(c), read(n.inverse_mass), read(n.velocity),
                        read(n.velocity_next), write(c.slip), write(c.state), value(w.step.solver.friction));
}

/// Looks at the step, and commits it when it can be trusted.
void list_join(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.nodes;
    ContactTable& c = w.contacts;
    BodyTable& b = w.bodies;
    ElementBlockTable& e = w.elements;
    NodeBlockTable& k = w.node_blocks;
    g.stage_with_result("dynamics/check_state", w.step.verdict, check_state,
                        bundle(
                            [&w, &n, &b, &k, &e] {
                                return CheckInputs{k.begin,    k.end,           k.body,     b.node_blocks, b.min_altitude,
                                                   n.velocity, n.velocity_next, w.pushes(), e.node,        b.blocks};
                            },
                            reads(k.begin, k.end, k.body, b.node_blocks, b.min_altitude, n.velocity, n.velocity_next, n.push_out,
                                  w.solver_memory, e.node, b.blocks)),
                        value(w.step.h), value(w.step.max_strain_step), write(k.max_speed_squared), write(b.max_speed));
    const auto possible = only_if([&w] { return w.step.verdict.fault == StepFault::none; }, reads(w.step.verdict));
    g.stage_with_result(
        "dynamics/find_inversions", w.step.inversions, find_inversions,
        bundle(
            [&w, &n, &b, &e] {
                return InversionInputs{e.node, e.volume, b.blocks, b.max_speed, b.travel, b.drift, n.position, n.velocity_next, w.pushes()};
            },
            reads(e.node, e.volume, b.blocks, b.max_speed, b.travel, b.drift, n.position, n.velocity_next, n.push_out, w.solver_memory)),
        value(w.step.h), make(w.inversion_parts),
        bundle(
            [&b, &e] {
                return InversionBudgets{e.sound_until, b.sound_until};
            },
            writes(e.sound_until, b.sound_until)),
        possible);
    g.stage_with_result("dynamics/measure_work", w.step.external, measure_work, bundle([&w] { return w.loads(); }, reads(n.load)),
                        read(n.force), read(w.attachments.node), read(n.velocity_next), value(w.step.h),
                        bundle([&w] { return w.resting_nodes(); }, reads(n.body, b.asleep)), make(w.work_parts),
                        only_if([&w] { return w.loaded || w.attachments.node.size() > 0; }, reads(w.attachments)));
    g.stage_with_result("collision/find_crossings", w.step.crossings, find_crossings, collision_inputs(w), value(w.step.collision),
                        value(w.step.h), read(n.velocity_next), read(n.push_out), make(w.pairs), make(w.crossings), possible);
    const auto trusted = only_if([&w] { return w.step.taken(); }, reads(w.step.verdict, w.step.crossings, w.step.inversions));
    const auto sleepy = only_if([&w] { return w.step.taken() && w.step.sleep.speed > 0; },
                                reads(w.step.verdict, w.step.crossings, w.step.inversions, w.step.sleep));
    const auto touches = bundle([&w] { return w.touches(); }, reads(c.first_body, c.second_body, c.state, c.gap, c.surface_velocity));
    g.stage("dynamics/wake_bodies", wake_bodies, touches, read(w.pressed), read(w.attachments.body), read(w.attachments.motion),
            write(b.asleep), write(b.calm), sleepy);
    g.stage("dynamics/advance_positions", advance_positions,
            bundle([&w, &n, &k] { return AdvanceInputs{k.begin, k.end, k.body, w.resting_bodies(), n.velocity_next, n.drift_origin}; },
                   reads(k.begin, k.end, k.body, b.asleep, n.velocity_next, n.drift_origin)),
            value(w.step.h), value(w.settings.integrator),
            bundle(
                [&w, &n, &k] {
                    return AdvanceOutputs{w.pushes(), n.position, n.velocity, k.drift_squared};
                },
                reads(w.solver_memory), writes(n.push_out, n.position, n.velocity, k.drift_squared)),
            trusted);
    g.stage("dynamics/measure_drift", measure_drift,
            bundle(
                [&n, &b, &k] {
                    return DriftInputs{k.drift_squared, b.node_blocks, b.nodes, b.mean_edge, n.position};
                },
                reads(k.drift_squared, b.node_blocks, b.nodes, b.mean_edge, n.position)),
            bundle(
                [&w, &n, &b] {
                    return DriftOutputs{n.drift_origin, w.search.memory.rebase, b.drift, b.travel};
                },
                writes(n.drift_origin, w.search.memory.rebase, b.drift, b.travel)),
            trusted);
    g.stage_with_result("dynamics/rest_bodies", w.step.rest, rest_bodies, touches,
                        bundle(
                            [&n, &b] {
                                return RestInputs{b.kind, b.nodes, b.max_speed, n.mass, n.inverse_mass};
                            },
                            reads(b.kind, b.nodes, b.max_speed, n.mass, n.inverse_mass)),
                        value(w.step.sleep), value(w.step.h), make(w.sleep_memory), write(b.asleep), write(b.calm), write(n.velocity),
                        write(n.velocity_next), sleepy);
    g.stage("contact/store_warm_start", store_warm_start, read(c.key), read(c.normal), read(c.impulse),
            bundle(
                [&w] {
                    return RestingPairs{w.pairs.key, w.pairs.resting};
                },
                reads(w.pairs)),
            value(w.step.h), make(w.warm_start), make(w.warm_start_next), trusted);
}

}  // namespace

void build_step(WorldState& world) {
    list_scripted_motion(world, world.graph);
    list_force_branch(world, world.graph);
    list_contact_branch(world, world.graph);
    list_solve(world, world.graph);
    list_join(world, world.graph);
    world.graph.compile();
}

}  // namespace skerry
