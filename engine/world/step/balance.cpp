#include "engine/world/step/balance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/ranks/regions/rank_mail.h"
#include "engine/world/state/model.h"
#include "engine/world/state/step_scratch.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

struct BodySums {
    Real kinetic = 0, elastic = 0, potential = 0;  // J
    Vec3 momentum = Vec3::Zero();                  // kg m/s
    // Sum of the magnitudes of the momenta of all nodes and bodies, and of the impulses of applied forces in a step.
    // Momentum errors are compared with it.
    Real momentum_size = 0;  // [kg m/s]
    bool damps_held_body = false, holds_implicit_element = false;

    void add(const BodySums& other) {
        kinetic += other.kinetic;
        elastic += other.elastic;
        potential += other.potential;
        momentum += other.momentum;
        momentum_size += other.momentum_size;
        damps_held_body |= other.damps_held_body;
        holds_implicit_element |= other.holds_implicit_element;
    }
};

bool of_ghost(const Model& model, std::size_t node) {
    return model.bodies.is_ghost(static_cast<std::size_t>(model.nodes.body[node]));
}

/// Returns the sum of energy(blocks) over the element blocks of all bodies but ghosts. Without ghosts it calls energy()
/// once with all blocks, otherwise once for each body.
Real sum_of_own_blocks(const Model& model, auto&& energy) {
    if (model.bodies.ghost.empty()) return energy(model.all_blocks());
    Real sum = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (!model.bodies.is_ghost(b)) sum += energy(model.bodies.blocks[b]);
    return sum;
}

/// Energy and momentum of the bodies that this rank owns.
BodySums measure(const Model& model, Real time, Real lag) {
    BodySums total;
    const NodeTable& nodes = model.nodes;
    for (std::size_t n = 0; n < nodes.position.size(); ++n) {
        if (of_ghost(model, n)) continue;
        total.potential -= nodes.mass[n] * model.settings.gravity.dot(nodes.position[n]);
        if (model.node_has_frame(n)) continue;
        const Vec3 momentum = nodes.mass[n] * nodes.velocity[n];
        total.momentum_size += momentum.norm();
        if (!(nodes.inverse_mass[n] > 0)) continue;
        total.kinetic += momentum.dot(nodes.velocity[n]) / 2;
        total.momentum += momentum;
    }
    Real implicit = 0;  // [J]
    // Momentum of all nodes and bodies whose velocities symplectic Euler changes; the power of gravity is computed from
    // it [kg m/s]. Held implicit bodies are not included, because the theta method integrates their motion.
    Vec3 kicked = total.momentum;
    for (const Index body : model.rigid_bodies.body) {
        const auto b = static_cast<std::size_t>(body);
        if ((model.is_held(b) && model.is_rigid(b)) || model.bodies.is_ghost(b)) continue;
        const RigidSums of_body = model.is_held(b) ? moving_sums(model, b) : rigid_sums(model, b);
        total.kinetic += of_body.kinetic;
        implicit += of_body.elastic;
        total.momentum += of_body.momentum;
        total.momentum_size += of_body.momentum.norm();
        if (!model.is_held(b)) kicked += of_body.momentum;
    }
    total.kinetic += added_energy(model);
    // Changes the kinetic energy to m v.v'/2 (to first order), with the mass m and the velocities v and v' of two
    // successive steps. The change is `lag` (half a step) times the power of all forces but contacts.
    //
    // Reason: for linear elastic bodies, symplectic Euler conserves the sum of this value and the elastic energy.
    if (lag != 0) {
        total.kinetic -=
            lag * sum_of_own_blocks(model, [&](const Range& blocks) {
                return kernels().elastic_power(model.all_elements(), blocks, nodes.position, nodes.velocity);
            });
        Real power = kicked.dot(model.settings.gravity);
        // Uses the applied forces of the last step (applied_before), because Balance::work contains the work of these
        // forces.
        if (model.forced)
            for (std::size_t n = 0; n < nodes.position.size(); ++n) {
                if (of_ghost(model, n)) continue;
                // Applied forces, for example of springs, exchange momentum even while all nodes are at rest. So
                // `momentum_size` includes their impulses. They act for the time of one step, twice the lag.
                total.momentum_size += 2 * std::abs(lag) * nodes.applied_before[n].norm();
                if (nodes.inverse_mass[n] > 0 && !model.is_held(static_cast<std::size_t>(nodes.body[n])))
                    power += nodes.applied_before[n].dot(nodes.velocity[n]);
            }
        total.kinetic += lag * power;
    }
    total.elastic = implicit + sum_of_own_blocks(model, [&](const Range& blocks) {
                        return kernels().elastic_energy(model.all_elements(), blocks, nodes.position);
                    });
    for (const ForceElement* element : force_elements)
        if (element->energy && element->any(model)) total.elastic += element->energy(model, time, lag);
    return total;
}

bool damps_held_body(const Model& model) {
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.pinned_count[b] > 0 && !model.is_rigid(b) && model.bodies.material[b] != no_index &&
            model.materials.damping[static_cast<std::size_t>(model.bodies.material[b])] > 0)
            return true;
    return false;
}

/// True if a node of an implicit element is held. Implicit integration gives the element an additional inertia, which
/// couples its nodes. Moving nodes then exert forces on the held node, which are not measured.
bool holds_implicit_element(const Model& model) {
    if (model.clusters.empty()) return false;
    const ElementInputs elements = model.all_elements();
    for (std::size_t block = 0; block < model.elements.implicit_modulus.size(); ++block)
        for (std::size_t lane = 0; lane < element_lanes; ++lane) {
            if (!(model.elements.implicit_modulus[block][lane] > 0)) continue;
            const BlockNodes nodes = elements.nodes_of(block);
            for (Index k = 0; k < nodes.count; ++k)
                if (!(model.nodes.inverse_mass[static_cast<std::size_t>(nodes.node[k][lane])] > 0)) return true;
        }
    return false;
}

}  // namespace

void add_step(const StepScratch& step, Balance& balance) {
    if (!balance.open) return;
    const ContactMeasures& contacts = step.findings.measures;
    const std::array<const ExternalWork*, 4> external{&step.findings.external, &step.findings.held,
                                                      &step.findings.held_rows, &step.findings.held_again};
    const std::array<Vec3, 7> impulses{step.parameters.kick_time * step.awake_mass * step.parameters.gravity,
                                       step.findings.strained.impulse,
                                       contacts.outer_impulse,
                                       step.findings.joints.impulse,
                                       step.findings.ties.impulse,
                                       step.findings.cables.impulse,
                                       -step.findings.rest.momentum};
    Real push_work = 0;
    if (step.regions.pushed)
        for (Real of_region : step.regions.push_work) push_work += of_region;
    Real work = push_work;
    // Balance::momentum_flow counts each cause with its magnitude. Impulses that cancel each other are exchanged
    // momentum too, for example those of weight and support, or those of two attachments that squeeze a body.
    Vec3 impulse = Vec3::Zero();
    for (const ExternalWork* part : external) {
        impulse += part->impulse;
        balance.momentum_flow += part->flow;
        work += part->work;
    }
    for (const Vec3& part : impulses) {
        impulse += part;
        balance.momentum_flow += part.norm();
    }
    work += step.findings.joints.work + step.findings.ties.work + step.findings.cables.work + contacts.outer_work -
            contacts.dissipated - step.findings.damped - step.findings.strained.damped - step.findings.relaxed -
            step.findings.viscous - step.findings.plastic - step.findings.rest.energy - step.findings.springs.work -
            step.findings.fibre_work - step.findings.cavity_work + step.findings.cavity_supply -
            step.findings.springs.dissipated;
    ++balance.steps;
    balance.impulse += impulse;
    balance.work += work;
    balance.energy_flow += std::abs(work);
}

void check_balance(const WorldState& world, Real time, Real lag, Balance& balance) {
    const Model& model = world.model;
    BodySums now = measure(model, time, lag);
    now.damps_held_body = !balance.open && damps_held_body(model);
    now.holds_implicit_element = holds_implicit_element(model);
    if (world.ranks.on()) {
        const BodySums own_sums = std::exchange(now, {});
        for_each_gathered<BodySums>(*world.ranks.ranks, std::span(&own_sums, 1),
                                    [&](const BodySums& of_rank) { now.add(of_rank); });
    }
    const Real energy = now.kinetic + now.elastic + now.potential;
    const bool was_open = balance.open;
    if (!was_open) {
        balance.open = true;
        balance.momentum_known = !now.damps_held_body;
        balance.energy = energy;
        balance.potential = now.potential;
        balance.momentum = now.momentum;
        balance.impulse.setZero();
        balance.steps = 0;
        balance.work = balance.energy_flow = balance.momentum_flow = 0;
    }
    // tested in every check, because elements may become implicit while the balance is open
    balance.momentum_known &= !now.holds_implicit_element;
    // Only the change of the potential energy counts as exchanged, since the zero point of this energy is arbitrary.
    const Real exchanged =
        now.kinetic + now.elastic + std::abs(now.potential - balance.potential) + balance.energy_flow;
    balance.energy_scale = std::max(balance.energy_scale, exchanged);
    balance.momentum_scale = std::max(balance.momentum_scale, now.momentum_size + balance.momentum_flow);
    balance.energy_error = std::max(balance.energy_error, std::abs(energy - balance.energy - balance.work));
    if (balance.momentum_known)
        balance.momentum_error =
            std::max(balance.momentum_error, (now.momentum - balance.momentum - balance.impulse).norm());
}

Balance checked_balance(const WorldState& world, Real time, Real lag, Balance balance) {
    if (balance.open && !world.ranks.on()) check_balance(world, time, lag, balance);
    return balance;
}

}  // namespace skerry
