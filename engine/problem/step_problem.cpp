#include "engine/problem/step_problem.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "systems/solver/local/load_contact.h"

namespace skerry {
namespace {

std::string description_of(const StepContacts& step, const SolverSettings& settings) {
    std::string text = "gaps may close within the step; existing penetration is corrected separately";
    bool two_coefficients = false;
    for (std::size_t i = 0; i < step.contacts.static_friction.size(); ++i)
        two_coefficients |= step.contacts.static_friction[i] != step.contacts.dynamic_friction[i];
    if (two_coefficients)
        text +=
            "; static friction differs from dynamic friction, and mu is the coefficient of dynamic friction, so the "
            "engine's solution does "
            "not solve this problem";
    if (std::ranges::any_of(step.contacts.friction_axis, [](const FrictionAxis& axis) { return axis.across != 1; }))
        text +=
            "; the friction of some contacts depends on the direction, and mu is the larger coefficient, so the "
            "engine's solution does not solve this problem";
    if (settings.friction == Friction::pyramid)
        text += "; the engine's solution is for the friction pyramid, not for the cone";
    return text;
}

/// Returns the clusters (groups of nodes with a common inertia matrix) that contacts touch.
std::vector<CoupledNodes> coupled_nodes(const RegionInputs& contacts) {
    std::vector<CoupledNodes> coupled;
    if (!contacts.clustered()) return coupled;
    const NodeClusters& clusters = *contacts.clusters;
    std::vector<bool> touched(clusters.size(), false);
    for (const Stencil& stencil : contacts.stencil)
        for (std::size_t a = 0; a < 4; ++a)
            if (const Index c = clusters.cluster(stencil.node[a]); stencil.weight[a] != 0 && c != no_index)
                touched[static_cast<std::size_t>(c)] = true;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        if (!touched[c]) continue;
        const std::span<const Index> nodes = clusters.nodes[c];
        const std::span<const Real> inverse =
            clusters.inverse.span().subspan(clusters.first_entry[c], nodes.size() * nodes.size());
        coupled.push_back({{nodes.begin(), nodes.end()}, {inverse.begin(), inverse.end()}});
    }
    return coupled;
}

/// Returns the rigid and implicit bodies that contacts touch, each with the nodes that contacts touch.
std::vector<RigidPoints> rigid_points(const RegionInputs& contacts) {
    const RigidInputs& rigid = contacts.rigid;
    std::map<Index, std::set<Index>> touched;
    for (const Stencil& stencil : contacts.stencil)
        for (std::size_t a = 0; a < 4; ++a)
            if (const Index row = rigid.nodes.row(stencil.node[a]);
                stencil.weight[a] != 0 && row != no_index &&
                contacts.inverse_mass[static_cast<std::size_t>(stencil.node[a])] > 0)  // inverse mass 0: held node
                touched[row].insert(stencil.node[a]);
    std::vector<RigidPoints> bodies;
    for (const auto& [row, nodes] : touched) {
        const auto r = static_cast<std::size_t>(row);
        RigidPoints points{{nodes.begin(), nodes.end()},
                           {},
                           rigid.inverse_mass(r),
                           rigid.spins.inverse_inertia[r],
                           rigid.nodes.radius(*nodes.begin())};
        for (const Index node : nodes)
            points.arm.push_back(rigid.position[static_cast<std::size_t>(node)] - rigid.center[r]);
        bodies.push_back(std::move(points));
    }
    return bodies;
}

/// For a cylinder, sets the contact point of each contact of the problem, relative to the centre of mass. Does nothing
/// for other bodies. rows[i]: row of contact i in the tables of the step.
void add_touches(const RegionInputs& contacts, const std::vector<Index>& rows, RigidPoints& body) {
    const RigidNodes& rigid = contacts.rigid.nodes;
    const Index middle = body.node.front();
    if (!rigid.is_cylinder(middle)) return;
    body.touch.assign(rows.size(), Vec3::Zero());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows[i]);
        const Stencil& stencil = contacts.stencil[row];
        for (std::size_t a = 0; a < 4; ++a)
            if (stencil.weight[a] != 0 && stencil.node[a] == middle)
                body.touch[i] = stencil.weight[a] *
                                rigid.core_arm(middle, stencil.weight[a], row, contacts.normal[row], contacts.touch);
    }
}

/// Returns the response of implicit bodies by deformation: velocity changes of the nodes that contacts touch, per
/// impulse on these nodes.
std::vector<StrainedPoints> strained_points(const RegionInputs& contacts) {
    std::vector<StrainedPoints> bodies;
    if (!contacts.implicit.any()) return bodies;
    const ImplicitCoupling& coupling = *contacts.implicit.coupling;
    for (std::size_t r = 0; r < coupling.nodes.size(); ++r) {
        const std::span<const Index> nodes = coupling.nodes[r];
        if (nodes.empty()) continue;
        StrainedPoints points{{nodes.begin(), nodes.end()}, {}};
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (std::size_t k = 0; k < nodes.size(); ++k)
                points.response.push_back(coupling.block(r, static_cast<Index>(i), static_cast<Index>(k)));
        bodies.push_back(std::move(points));
    }
    return bodies;
}

/// Erases the contacts with the given numbers from a problem. `contacts`: ascending numbers.
void erase_contacts(std::span<const Index> contacts, StepProblem& problem) {
    std::vector<Index> kept;
    for (Index i = 0; i < problem.problem.contacts(); ++i)
        if (!std::ranges::binary_search(contacts, i)) kept.push_back(i);
    const auto erase_others = [&]<class T>(std::vector<T>& values) {
        if (values.empty()) return;
        for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[static_cast<std::size_t>(kept[i])];
        values.resize(kept.size());
    };
    if (kept.empty())
        problem.problem = {};
    else
        problem.problem = part_of(problem.problem, kept);
    LumpedContacts& lumped = problem.lumped;
    erase_others(lumped.node);
    erase_others(lumped.weight);
    erase_others(lumped.normal);
    erase_others(lumped.offset);
    erase_others(lumped.friction);
    for (RigidPoints& body : lumped.rigid) erase_others(body.touch);
    erase_others(problem.impulse);
    erase_others(problem.contact);
    erase_others(problem.region);
}

}  // namespace

StepProblem step_problem(const StepContacts& step, const SolverSettings& settings, Real h) {
    StepProblem result;
    LumpedContacts& lumped = result.lumped;
    lumped.inverse_mass.assign(step.contacts.inverse_mass.begin(), step.contacts.inverse_mass.end());
    lumped.velocity.assign(step.free_velocity.begin(), step.free_velocity.end());
    std::vector<Vec3> impulse;
    for (std::size_t row = 0; row < step.contacts.stencil.size(); ++row) {
        bool on_rigid_body = false;
        const LumpedContact contact = load_contact(
            step.contacts, static_cast<Index>(row), step.free_velocity, settings, h, [](Index node) { return node; },
            [&](Index node, Real) {
                const bool rigid = step.contacts.rigid.nodes.row(node) != no_index;
                on_rigid_body |= rigid;
                return rigid;
            });
        if (contact.node_count == 0 && !on_rigid_body) continue;
        lumped.node.push_back(step.contacts.stencil[row].node);
        lumped.weight.push_back(step.contacts.stencil[row].weight);
        lumped.normal.push_back(step.contacts.normal[row]);
        const RigidInputs& rigid = step.contacts.rigid;
        const Vec3 rolling =
            rigid.nodes.rolling(step.contacts.stencil[row], row, step.contacts.normal[row], step.contacts.touch,
                                [&](std::size_t r) { return rigid.spins.kicked(r); });
        lumped.offset.push_back(contact.bias * step.contacts.normal[row] - step.contacts.surface_velocity[row] -
                                midpoint_slip(step.contacts, static_cast<Index>(row), step.free_velocity) + rolling);
        lumped.friction.push_back(contact.friction.slide);
        impulse.push_back(step.impulse[row]);
        result.contact.push_back(static_cast<Index>(row));
        result.region.push_back(step.region[row]);
    }
    lumped.coupled = coupled_nodes(step.contacts);
    lumped.rigid = rigid_points(step.contacts);
    for (RigidPoints& body : lumped.rigid) add_touches(step.contacts, result.contact, body);
    lumped.strained = strained_points(step.contacts);
    result.problem = assemble_problem(lumped, {});
    result.problem.description = description_of(step, settings);
    result.impulse = in_contact_frames(lumped, impulse);
    if (const std::optional<std::vector<Index>> immovable =
            eliminate_equations(step.equations, step.contacts, result.contact, result.impulse, result.problem)) {
        if (!immovable->empty()) erase_contacts(*immovable, result);
        result.problem.description +=
            "; W and q include the joints, ties and rollers of the bodies, and the impulses of their motors, limits, "
            "slides and cables in the step";
        if (!immovable->empty())
            result.problem.description += "; contacts left out because no impulse moves them along their normals: " +
                                          std::to_string(immovable->size()) + "; q includes their impulses in the step";
    }
    return result;
}

}  // namespace skerry
