#include "engine/world/step/weigh_springs.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/world/step/seams.h"

namespace skerry {

SpringInputs springs_of(const Model& model) {
    return SpringInputs::bind({}, model.springs, model.bodies, model.nodes, model.colliders, model.any_asleep);
}

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

namespace {

/// Part of the inverse mass of an anchor (end of a spring) that comes from the rigid motion of its body: upper bound
/// over all directions of the force [1/kg]. It is 0 for held bodies, and for explicit bodies, which move by their nodes
/// only.
Real inverse_mass_of_frame(const Model& model, const AnchorInputs& anchors, std::size_t s) {
    if (anchors.body[s] == no_index) return 0;
    const auto body = static_cast<std::size_t>(anchors.body[s]);
    if (!model.has_frame(body) || model.is_held(body)) return 0;
    const RigidBodyTable& rigid = model.rigid_bodies;
    const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
    const Real arm = (anchors.at(s) - rigid.center[r]).squaredNorm();
    return 1 / rigid.mass[r] + (arm > 0 ? arm / rigid.moments[r].minCoeff() : Real(0));
}

}  // namespace

// A spring of the stiffness k has anchors with the inverse masses u and v on two bodies. It raises the squared circular
// frequencies of the first body by at most k (u + sqrt(u v)), and those of the second by k (v + sqrt(u v)) (block form
// of Gershgorin's theorem, docs/methods/springs.md 2).
void add_spring_rates(Model& model, std::span<Real> of_body) {
    const SpringInputs springs = springs_of(model);
    for (std::size_t s = 0; s < springs.size(); ++s) {
        const Real first = model.springs.first_mass[s].inverse + inverse_mass_of_frame(model, springs.first, s),
                   second = model.springs.second_mass[s].inverse + inverse_mass_of_frame(model, springs.second, s);
        const Real joined = std::sqrt(first * second);
        const Real stiffness = (springs.side[s] == SpringSide::both ? 1 : kink_factor) * springs.stiffness[s];
        if (springs.first.body[s] != no_index)
            of_body[static_cast<std::size_t>(springs.first.body[s])] += stiffness * (first + joined);
        if (springs.second.body[s] != no_index)
            of_body[static_cast<std::size_t>(springs.second.body[s])] += stiffness * (second + joined);
    }
}

// Raises the bound of each body to the largest rate of a single damper on it, computed as if n dampers on one mass had
// equal shares of it. This suffices: for the coefficients c_i and the mass m, the largest n c_i / m is at least the sum
// of all c_i / m.
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

}  // namespace skerry
