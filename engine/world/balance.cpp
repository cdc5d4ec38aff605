#include "engine/world/balance.h"

#include <algorithm>

#include "engine/world/world_state.h"
#include "systems/dynamics/element_energy.h"

namespace skerry {

namespace {

struct Present {
    Real kinetic = 0, elastic = 0, potential = 0;  // J
    Vec3 momentum = Vec3::Zero();                  // kg m/s
    Real momentum_size = 0;                        // kg m/s, sum of m |v|
};

Present measure(const WorldState& world) {
    Present now;
    const NodeTable& nodes = world.nodes;
    for (std::size_t n = 0; n < nodes.position.size(); ++n) {
        now.potential -= nodes.mass[n] * world.step.gravity.dot(nodes.position[n]);
        if (!(nodes.inverse_mass[n] > 0)) continue;
        const Vec3 momentum = nodes.mass[n] * nodes.velocity[n];
        now.kinetic += momentum.dot(nodes.velocity[n]) / 2;
        now.momentum += momentum;
        now.momentum_size += momentum.norm();
    }
    now.elastic = elastic_energy(world.element_inputs(), {0, static_cast<Index>(world.elements.node.size())}, nodes.position);
    return now;
}

bool damps_held_body(const WorldState& world) {
    for (std::size_t b = 0; b < world.bodies.slot.size(); ++b)
        if (world.bodies.pinned_count[b] > 0 && world.bodies.material[b] != no_index &&
            world.materials.damping[static_cast<std::size_t>(world.bodies.material[b])] > 0)
            return true;
    return false;
}

void check(const WorldState& world, Balance& balance) {
    const Present now = measure(world);
    const Real energy = now.kinetic + now.elastic + now.potential;
    const bool was_open = balance.open;
    if (!was_open) {
        balance.open = true;
        balance.momentum_known = !damps_held_body(world);
        balance.energy = energy;
        balance.potential = now.potential;
        balance.momentum = now.momentum;
        balance.impulse.setZero();
        balance.steps = 0;
        balance.work = balance.energy_flow = balance.momentum_flow = 0;
    }
    // the height of a weight means nothing: what it fell does
    const Real exchanged = now.kinetic + now.elastic + std::abs(now.potential - balance.potential) + balance.energy_flow;
    balance.energy_scale = std::max(balance.energy_scale, exchanged);
    balance.momentum_scale = std::max(balance.momentum_scale, now.momentum_size + balance.momentum_flow);
    balance.energy_error = std::max(balance.energy_error, std::abs(energy - balance.energy - balance.work));
    if (balance.momentum_known)
        balance.momentum_error = std::max(balance.momentum_error, (now.momentum - balance.momentum - balance.impulse).norm());
}

}  // namespace

void add_step(WorldState& world) {
    Balance& balance = world.balance;
    if (!balance.open) return;
    const ContactMeasures& contacts = world.step.measures;
    const ExternalWork& external = world.step.external;
    const Vec3 impulse =
        world.step.h * world.step.awake_mass * world.step.gravity + external.impulse + contacts.outer_impulse - world.step.rest.momentum;
    const Real work = external.work + contacts.outer_work - contacts.dissipated - world.step.damped - world.step.rest.energy;
    ++balance.steps;
    balance.impulse += impulse;
    balance.momentum_flow += impulse.norm();
    balance.work += work;
    balance.energy_flow += std::abs(work);
}

void check_balance(WorldState& world) {
    check(world, world.balance);
}

Balance checked_balance(const WorldState& world) {
    Balance balance = world.balance;
    if (balance.open) check(world, balance);
    return balance;
}

}  // namespace skerry
