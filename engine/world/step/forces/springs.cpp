// Force element of springs and dampers (docs/methods/springs.md).
#include "systems/forces/springs.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/world/step/seams.h"
#include "systems/dynamics/implicit/respond_at_anchors.h"

namespace skerry {

namespace {

bool any_spring(const Model& model) {
    return model.springs.size() > 0;
}

SpringInputs springs_of(const Model& model) {
    return SpringInputs::bind({}, model.springs, model.bodies, model.nodes, model.colliders, model.any_asleep);
}

auto spring_inputs(const Model& m) {
    return inputs<SpringInputs>(m.springs, m.bodies, m.nodes, m.colliders, m.any_asleep);
}

auto if_any_spring(const Model& m) {
    return only_if([](std::span<const std::uint32_t> slot) { return !slot.empty(); }, read(m.springs.slot));
}

/// Computes the inverse masses of the anchors of all springs, and the number of dampers that share each mass.
void weigh_springs(Model& model) {
    SpringTable& springs = model.springs;
    const SpringInputs inputs = springs_of(model);
    std::vector<Index> of_node(model.nodes.position.size(), 0), of_body(model.bodies.slot.size(), 0);
    const auto count = [&](const AnchorInputs& anchors, std::size_t s) {
        if (anchors.body[s] == no_index || !(springs.damping[s] > 0)) return;
        ++of_body[static_cast<std::size_t>(anchors.body[s])];
        anchors.for_each_node(s, [&](std::size_t node, Real) { ++of_node[node]; });
    };
    for (std::size_t s = 0; s < springs.size(); ++s) {
        count(inputs.first, s);
        count(inputs.second, s);
    }
    const auto weigh = [&](const AnchorInputs& anchors, std::size_t s) {
        AnchorMass mass;
        if (anchors.body[s] == no_index) return mass;
        const auto body = static_cast<std::size_t>(anchors.body[s]);
        if (model.has_frame(body)) mass.dampers = of_body[body];
        if (model.is_rigid(body)) return mass;
        anchors.for_each_node(s, [&](std::size_t node, Real weight) {
            const Real inverse = weight * weight * model.nodes.inverse_mass[node];
            mass.inverse += inverse;
            mass.divided += of_node[node] * inverse;
        });
        return mass;
    };
    for (std::size_t s = 0; s < springs.size(); ++s) {
        springs.first_mass[s] = weigh(inputs.first, s);
        springs.second_mass[s] = weigh(inputs.second, s);
    }
}

/// Upper bound, for all directions, of the inverse mass of the frame of a rigid or implicit body at an anchor [1/kg].
Real inverse_mass_of_frame(const Model& model, const AnchorInputs& anchors, std::size_t s) {
    if (anchors.body[s] == no_index) return 0;
    const auto body = static_cast<std::size_t>(anchors.body[s]);
    if (!model.has_frame(body) || model.is_held(body)) return 0;
    const RigidBodyTable& rigid = model.rigid_bodies;
    const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
    const Real arm = (anchors.at(s) - rigid.center[r]).squaredNorm();
    return 1 / rigid.mass[r] + (arm > 0 ? arm / rigid.moments[r].minCoeff() : Real(0));
}

// A spring of stiffness k between anchors with the inverse masses u and v, on two bodies, adds a matrix to the squared
// frequencies whose blocks have the norms k u, k sqrt(u v) and k v. By the block form of Gershgorin's theorem the
// largest squared frequency grows by at most the largest sum of norms in a row.
void add_spring_rates(const Model& model, std::span<Real> of_body) {
    const SpringInputs springs = springs_of(model);
    for (std::size_t s = 0; s < springs.size(); ++s) {
        const Real first = model.springs.first_mass[s].inverse + inverse_mass_of_frame(model, springs.first, s),
                   second = model.springs.second_mass[s].inverse + inverse_mass_of_frame(model, springs.second, s);
        const Real joined = std::sqrt(first * second);
        if (springs.first.body[s] != no_index)
            of_body[static_cast<std::size_t>(springs.first.body[s])] += springs.stiffness[s] * (first + joined);
        if (springs.second.body[s] != no_index)
            of_body[static_cast<std::size_t>(springs.second.body[s])] += springs.stiffness[s] * (second + joined);
    }
}

// If each mass is divided among the dampers that act on it, a damper reduces a velocity at most by its own factor.
void bound_spring_damping(const Model& model, std::span<Real> of_body) {
    const SpringInputs springs = springs_of(model);
    const auto divided = [&](const AnchorMass& mass, const AnchorInputs& anchors, std::size_t s) {
        return mass.dampers == 0 ? mass.divided
                                 : mass.dampers * (mass.inverse + inverse_mass_of_frame(model, anchors, s));
    };
    for (std::size_t s = 0; s < springs.size(); ++s) {
        const Real rate = springs.damping[s] * (divided(model.springs.first_mass[s], springs.first, s) +
                                                divided(model.springs.second_mass[s], springs.second, s));
        for (const Index body : {springs.first.body[s], springs.second.body[s]})
            if (body != no_index)
                of_body[static_cast<std::size_t>(body)] = std::max(of_body[static_cast<std::size_t>(body)], rate);
    }
}

void list_spring_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/respond_at_anchors", respond_at_anchors,
            inputs<ImplicitBodies>(m.rigid_bodies, m.bodies, m.materials, m.implicit_nodes, m.nodes, m.attachments,
                                   m.any_asleep),
            inputs<DampedAnchors>(m.springs, m.bodies), inputs<ImplicitTimes>(p.h, p.theta, p.long_step),
            make(m.stiff_bodies), outputs<AnchorResponses>(m.springs), if_any_spring(m));
    g.stage("forces/add_spring_forces", add_spring_forces, spring_inputs(m),
            inputs<SpringMasses>(m.springs, m.bodies, m.rigid_bodies), value(w.clock.time), value(p.h), value(p.kick),
            write(m.springs.next), write(m.nodes.applied_force), if_any_spring(m));
}

void list_driven_springs(WorldState& w, TaskGraph& g) {
    const auto if_any_asleep = only_if([](bool any_asleep) { return any_asleep; }, value(w.model.any_asleep));
    g.stage("forces/mark_driven_bodies", mark_driven_bodies, spring_inputs(w.model), value(w.clock.time),
            value(w.scratch.parameters.h), write(w.scratch.pressed), if_any_asleep);
}

bool a_spring_is_driven(const Model& model, Real t, Real h) {
    const SpringInputs springs = springs_of(model);
    for (std::size_t s = 0; s < springs.size(); ++s)
        if (springs.is_driven(s, t, h)) return true;
    return false;
}

void list_spring_measures(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("forces/measure_springs", w.scratch.findings.springs, measure_springs, spring_inputs(m),
                        inputs<SpringWorkInputs>(m.springs, m.nodes), value(p.h), value(p.kick), value(p.work_lag),
                        if_any_spring(m));
}

void list_spring_memory(WorldState& w, TaskGraph& g) {
    SpringTable& springs = w.model.springs;
    g.stage("forces/keep_spring_forces", keep_spring_forces, read(springs.next), outputs<SpringMemory>(springs),
            if_taken(w));
}

Real energy_of_springs(const Model& model, Real t, Real lag) {
    return spring_energy(springs_of(model), SpringWorkInputs::bind({}, model.springs, model.nodes), t, lag);
}

}  // namespace

constinit const ForceElement spring_forces{.any = any_spring,
                                           .add_forces = list_spring_forces,
                                           .derive = weigh_springs,
                                           .add_rate = add_spring_rates,
                                           .bound_damping = bound_spring_damping,
                                           .mark_driven = list_driven_springs,
                                           .is_driven = a_spring_is_driven,
                                           .measure = list_spring_measures,
                                           .remember = list_spring_memory,
                                           .energy = energy_of_springs};

}  // namespace skerry
