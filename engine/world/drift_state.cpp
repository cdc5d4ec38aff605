// What leapfrog does before its first and after its last kick: positions drift by half a step, so that between them kicks come in the middle of
// their steps while the state at both ends belongs to one time. Each step is symmetric in time, whatever its length.
#include "engine/world/world_state.h"
#include "systems/dynamics/advance_positions.h"
#include "systems/dynamics/measure_drift.h"
#include "systems/dynamics/move_colliders.h"

namespace skerry {

namespace {

void measure_drift_of(WorldState& world) {
    NodeTable& n = world.nodes;
    NodeBlockTable& k = world.node_blocks;
    BodyTable& b = world.bodies;
    measure_drift(*world.executor, {k.drift_squared, b.node_blocks, b.nodes, b.mean_edge, n.position},
                  {n.drift_origin, world.search.memory.rebase, b.drift, b.travel});
}

}  // namespace

void drift_to(WorldState& world, Real offset) {
    const Real seconds = offset - world.step.offset;
    if (seconds == 0) return;
    NodeTable& n = world.nodes;
    AttachmentTable& a = world.attachments;
    ColliderTable& c = world.colliders;
    move_colliders({c.script, c.keyframe, c.initial}, world.step.time, seconds, c.motion);
    move_colliders({a.script, a.keyframe, a.initial}, world.step.time, seconds, a.motion);
    drive_nodes({a.motion, a.nodes, a.node, a.anchor}, seconds, n.position, n.velocity);
    NodeBlockTable& k = world.node_blocks;
    advance_positions(*world.executor, {k.begin, k.end, k.body, world.resting_bodies(), n.velocity, n.drift_origin}, seconds,
                      Integrator::leapfrog, {{}, n.position, n.velocity, k.drift_squared});
    measure_drift_of(world);
    add_collider_travel(world, std::abs(seconds));
    world.step.time += seconds;
    world.step.offset = offset;
}

void keep_start(WorldState& world) {
    if (world.settings.integrator != Integrator::leapfrog) return;
    world.start.time = world.step.time;
    world.start.position = world.nodes.position;
    world.start.velocity = world.nodes.velocity;
}

void put_back_start(WorldState& world) {
    if (world.settings.integrator != Integrator::leapfrog) return;
    NodeTable& n = world.nodes;
    NodeBlockTable& k = world.node_blocks;
    n.position = world.start.position;
    n.velocity = world.start.velocity;
    world.step.time = world.start.time;
    world.step.offset = 0;
    for (std::size_t b = 0; b < k.begin.size(); ++b) {
        const auto first = static_cast<std::size_t>(k.begin[b]), count = static_cast<std::size_t>(k.end[b]) - first;
        k.drift_squared[b] = block_drift_squared(n.position.span().subspan(first, count), n.drift_origin.span().subspan(first, count));
    }
    measure_drift_of(world);
}

}  // namespace skerry
