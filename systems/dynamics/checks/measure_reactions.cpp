#include "systems/dynamics/checks/measure_reactions.h"

#include <Eigen/Geometry>
#include <cmath>

#include "components/check.h"
#include "systems/dynamics/clusters/implicit_elements.h"

namespace skerry {

namespace {

bool is_awake(const ReactionInputs& inputs, Index body) {
    const auto b = static_cast<std::size_t>(body);
    return inputs.kind[b] == BodyKind::deformable && !inputs.asleep[b];
}

/// True for an awake body that is explicit or implicit. The reactions on such a body are measured node by node, those
/// on a rigid body as a whole (add_rigid_body).
bool is_measured_by_node(const ReactionInputs& inputs, Index body) {
    const auto b = static_cast<std::size_t>(body);
    return is_awake(inputs, body) && (inputs.body_rigid[b].size() == 0 || inputs.body_implicit[b].size() > 0);
}

/// True for an attachment that holds all three velocity components of its nodes, on an awake body that is not rigid.
bool holds_measured_nodes(const ReactionInputs& inputs, std::size_t attachment) {
    return holds_completely(inputs.directions[attachment]) &&
           is_measured_by_node(inputs, inputs.attached_body[attachment]);
}

/// Adds the reaction on nodes that are held along single directions: the impulses that hold_axes has applied.
void add_axes(const ReactionInputs& inputs, const Vec3& moment_point, std::size_t a, ImpulseAndMoment& reaction) {
    if (holds_completely(inputs.directions[a])) return;
    for (auto i = static_cast<std::size_t>(inputs.attached[a].begin);
         i < static_cast<std::size_t>(inputs.attached[a].end); ++i) {
        const Vec3& impulse = inputs.axis_impulse[i];
        reaction +=
            {impulse, (inputs.position[static_cast<std::size_t>(inputs.held[i])] - moment_point).cross(impulse)};
    }
}

/// Adds the reaction on a rigid body that attachment `a` holds: the change of the body's momentum (inputs.kick) minus
/// the impulses of weight, loads and contacts on its nodes. A held implicit body adds only the moment that holds its
/// frame, because the reactions on its nodes are added one by one.
void add_rigid_body(const ReactionInputs& inputs, Real kick, const Vec3& moment_point, std::size_t a,
                    ImpulseAndMoment& reaction) {
    const Range rows = inputs.body_rigid[static_cast<std::size_t>(inputs.attached_body[a])];
    if (rows.size() == 0 || inputs.holder[static_cast<std::size_t>(rows.begin)] != static_cast<Index>(a)) return;
    const auto r = static_cast<std::size_t>(rows.begin);
    if (inputs.body_implicit[static_cast<std::size_t>(inputs.attached_body[a])].size() > 0) {
        reaction += {Vec3::Zero(), inputs.hold_moment[r]};
        return;
    }
    reaction += {inputs.kick[r], inputs.moment_kick[r] + (inputs.center[r] - moment_point).cross(inputs.kick[r])};
    for (auto i = static_cast<std::size_t>(inputs.attached[a].begin);
         i < static_cast<std::size_t>(inputs.attached[a].end); ++i) {
        const auto n = static_cast<std::size_t>(inputs.held[i]);
        const Vec3 others = -(kick * inputs.force[n] + inputs.held_impulse[n]);
        reaction += {others, (inputs.position[n] - moment_point).cross(others)};
    }
}

/// Fraction of the velocity of a body's nodes that damping removes in the time `kick` [s].
Real damped_fraction(const ReactionInputs& inputs, std::size_t body, Real kick) {
    const Index material = inputs.body_material[body];
    return material == no_index ? 0 : -std::expm1(-inputs.material_damping[static_cast<std::size_t>(material)] * kick);
}

/// Adds the impulses on held nodes that come from the added inertia of the implicit elements (docs/methods/clusters.md
/// 1). An element has beta = inertia_factor(), the volume V, and the assumed modulus c. Let g_k be the gradient of its
/// shape function of node k. A velocity change dv_k of its moving node k requires the impulse beta c V (g_k.g_n) dv_k
/// on each held node n. Velocity changes by damping do not count.
void add_implicit_elements(const ReactionInputs& inputs, std::size_t body, Real kick, Column<Vec3>& node_impulse) {
    const Real beta = inertia_factor(inputs.cluster_step[body]);
    const Real damped = damped_fraction(inputs, body, kick);
    for (auto b = static_cast<std::size_t>(inputs.blocks[body].begin);
         b < static_cast<std::size_t>(inputs.blocks[body].end); ++b)
        for (std::size_t lane = 0; lane < element_lanes; ++lane) {
            if (!(inputs.implicit_modulus[b][lane] > 0)) continue;
            const Real weight = beta * inputs.implicit_modulus[b][lane] * inputs.volume[b][lane];
            const auto begin = static_cast<std::size_t>(inputs.first[b]),
                       end = begin + static_cast<std::size_t>(inputs.count[b]);
            Mat3 change = Mat3::Zero();  // change of the velocity gradient in the step
            for (std::size_t k = begin; k < end; ++k) {
                const auto n = static_cast<std::size_t>(inputs.element_node[k][lane]);
                if (!(inputs.inverse_mass[n] > 0)) continue;
                const Vec3 gained = inputs.velocity_next[n] - (1 - damped) * inputs.velocity[n];
                for (std::size_t i = 0; i < 3; ++i)
                    change.col(static_cast<Eigen::Index>(i)) += inputs.gradient[k][i][lane] * gained;
            }
            for (std::size_t k = begin; k < end; ++k) {
                const auto n = static_cast<std::size_t>(inputs.element_node[k][lane]);
                if (inputs.inverse_mass[n] > 0) continue;
                const Vec3 gradient(inputs.gradient[k][0][lane], inputs.gradient[k][1][lane],
                                    inputs.gradient[k][2][lane]);
                node_impulse[n] += weight * (change * gradient);
            }
        }
}

}  // namespace

void measure_reactions(const ReactionInputs& inputs, Real kick, const Vec3& moment_point, Column<Vec3>& node_impulse,
                       Column<ImpulseAndMoment>& reactions) {
    const std::size_t count = inputs.attached.size();
    SKERRY_CHECK(inputs.velocity_before.size() == inputs.velocity.size());
    reactions.assign(count, {});
    node_impulse.resize(inputs.position.size());
    // Computes the impulse on each held node. If several attachments hold a node, each of them writes the same value.
    for (std::size_t a = 0; a < count; ++a) {
        if (!holds_measured_nodes(inputs, a)) continue;
        for (auto i = static_cast<std::size_t>(inputs.attached[a].begin);
             i < static_cast<std::size_t>(inputs.attached[a].end); ++i) {
            const auto n = static_cast<std::size_t>(inputs.held[i]);
            node_impulse[n] = inputs.mass[n] * (inputs.velocity[n] - inputs.velocity_before[n]) -
                              kick * inputs.force[n] - inputs.held_impulse[n];
        }
    }
    Index last = no_index;
    for (std::size_t a = 0; a < count; ++a) {
        const Index body = inputs.attached_body[a];
        // A body is handled once, at its first attachment. Its other attachments may stand anywhere later in the list.
        bool done = body == last || !is_measured_by_node(inputs, body) ||
                    !(inputs.cluster_step[static_cast<std::size_t>(body)] > 0);
        for (std::size_t earlier = 0; earlier < a && !done; ++earlier) done = inputs.attached_body[earlier] == body;
        if (!done) add_implicit_elements(inputs, static_cast<std::size_t>(body), kick, node_impulse);
        last = body;
    }
    for (std::size_t a = 0; a < count; ++a) {
        if (!is_awake(inputs, inputs.attached_body[a])) continue;
        add_rigid_body(inputs, kick, moment_point, a, reactions[a]);
        add_axes(inputs, moment_point, a, reactions[a]);
    }
    // Attachments are visited in reverse order, so that the impulse of a node goes to the last attachment that holds
    // it.
    for (std::size_t a = count; a-- > 0;) {
        if (!holds_measured_nodes(inputs, a)) continue;
        for (auto i = static_cast<std::size_t>(inputs.attached[a].begin);
             i < static_cast<std::size_t>(inputs.attached[a].end); ++i) {
            const auto n = static_cast<std::size_t>(inputs.held[i]);
            reactions[a] += {node_impulse[n], (inputs.position[n] - moment_point).cross(node_impulse[n])};
            node_impulse[n].setZero();
        }
    }
}

}  // namespace skerry
