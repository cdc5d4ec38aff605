#include "engine/problem/step_problem.h"

#include <algorithm>

#include "engine/problem/gather_blocks.h"
#include "systems/contact/tangent_frame.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {
namespace {

/// Columns: normal, tangent 1, tangent 2.
Mat3 frame_of(const Vec3& normal) {
    const TangentFrame tangents = tangent_frame(normal);
    Mat3 frame;
    frame << normal, tangents.first, tangents.second;
    return frame;
}

/// A contact at a node.
struct Touch {
    Index node, contact;
    Real weight;
};

std::string description_of(const StepContacts& step, const SolverSettings& settings) {
    std::string text = "gaps may close within the step; contacts that are pressed in are pushed out apart from this";
    bool two_coefficients = false;
    for (std::size_t i = 0; i < step.contacts.static_friction.size(); ++i)
        two_coefficients |= step.contacts.static_friction[i] != step.contacts.dynamic_friction[i];
    if (two_coefficients)
        text += "; static friction differs from dynamic friction, and mu is the dynamic one, so the solution is not one of this problem";
    if (settings.friction == Friction::pyramid) text += "; the solution is that of the friction pyramid, not of the cone";
    if (settings.friction == Friction::cone_convex) text += "; the solution is that of the associated law, not of Coulomb's";
    return text;
}

}  // namespace

StepProblem step_problem(const StepContacts& step, const SolverSettings& settings, Real h) {
    StepProblem result;
    ContactProblem& problem = result.problem;
    std::vector<Mat3> frame;
    std::vector<Touch> touches;
    for (std::size_t row = 0; row < step.contacts.stencil.size(); ++row) {
        const LumpedContact contact =
            load_contact(step.contacts, static_cast<Index>(row), step.free_velocity, settings, h, [](Index node) { return node; });
        if (contact.node_count == 0) continue;
        const Index i = problem.contacts();
        Vec3 velocity = contact.offset.head<3>();
        for (Index a = 0; a < contact.node_count; ++a) {
            touches.push_back({contact.node[a], i, contact.weight[a]});
            velocity += contact.weight[a] * step.free_velocity[contact.node[a]];
        }
        frame.push_back(frame_of(step.contacts.normal[row]));
        problem.q.push_back(frame.back().transpose() * velocity);
        problem.mu.push_back(contact.friction.slide);
        result.impulse.push_back(frame.back().transpose() * step.impulse[row]);
        result.contact.push_back(static_cast<Index>(row));
        result.region.push_back(step.region[row]);
    }
    std::stable_sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) { return a.node < b.node; });
    std::vector<BlockPart> parts;
    for (std::size_t begin = 0, end = 0; begin < touches.size(); begin = end) {
        while (end < touches.size() && touches[end].node == touches[begin].node) ++end;
        const Real inverse_mass = step.contacts.inverse_mass[touches[begin].node];
        for (std::size_t a = begin; a < end; ++a)
            for (std::size_t b = begin; b < end; ++b) {
                const Index i = touches[a].contact, j = touches[b].contact;
                // S_ij of methods.md 0.1, symmetric to the last bit; a block of the diagonal is the same in every frame
                const Real coupling = touches[a].weight * touches[b].weight * inverse_mass;
                parts.push_back({i, j, i == j ? Mat3(coupling * Mat3::Identity()) : Mat3(coupling * (frame[i].transpose() * frame[j]))});
            }
    }
    gather_blocks(std::move(parts), problem);
    problem.description = description_of(step, settings);
    return result;
}

}  // namespace skerry
