#include "systems/dynamics/motion/hold_axes.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "components/write_contact.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// A direction along which an attachment holds a node.
struct HeldDirection {
    std::size_t entry;   // row of AttachmentTable::node
    std::size_t column;  // column of AttachmentTable::held
    std::size_t node;    // row of NodeTable
    Vec3 direction;      // unit vector
    Real speed;          // prescribed velocity along the direction [m/s]
};

/// Calls visit(HeldDirection) for each direction along which an attachment holds a node.
void for_each_held(const AxisHoldInputs& inputs, Real h, auto&& visit) {
    for (std::size_t a = 0; a < inputs.nodes.size(); ++a) {
        if (holds_completely(inputs.held[a])) continue;
        const RigidMotion& motion = inputs.motion[a];
        const Vec3 end = motion.position + h * motion.velocity;
        const Mat3 rotation = rotation_matrix(h * motion.angular_velocity) * motion.rotation;
        for (auto i = static_cast<std::size_t>(inputs.nodes[a].begin);
             i < static_cast<std::size_t>(inputs.nodes[a].end); ++i) {
            const auto n = static_cast<std::size_t>(inputs.node[i]);
            if (!(inputs.inverse_mass[n] > 0) || inputs.resting.contain(n)) continue;
            const Vec3 velocity = (end + rotation * inputs.anchor[i] - inputs.position[n]) / h;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 direction = inputs.held[a].col(static_cast<Eigen::Index>(k));
                if (!direction.isZero(0))
                    visit(
                        {.entry = i, .column = k, .node = n, .direction = direction, .speed = direction.dot(velocity)});
            }
        }
    }
}

/// Calls visit(node, weight) for each node of a stencil whose weight is not zero.
void for_each_node(const Stencil& stencil, auto&& visit) {
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0) visit(static_cast<std::size_t>(stencil.node[a]), stencil.weight[a]);
}

/// True if the gap of contact `c` can change while its nodes move only perpendicular to the directions along which they
/// are held. Always true for a contact without held nodes.
bool moves_held_nodes(const AxisHoldInputs& inputs, const ContactTable& contacts, std::size_t c,
                      std::span<const HeldRows::Node> node) {
    // Lower limit on the share of the mobility (inverse mass) along the normal that the held directions leave to the
    // nodes. Below this limit the gap counts as unable to change.
    constexpr Real least_share = 1e-6;
    Real all = 0, free_mobility = 0;
    for_each_node(contacts.stencil[c], [&](std::size_t n, Real weight) {
        const Real mobility = weight * weight * inputs.inverse_mass[n];
        all += mobility;
        free_mobility += mobility * (1 - contacts.normal[c].dot(node[n].held * contacts.normal[c]));
    });
    return free_mobility > least_share * all;
}

/// Key of the row that holds a node along one direction. These rows are the last rows of ContactTable, which is in key
/// order. So their keys are greater than all keys of contacts and ties.
ContactKey key_of(const HeldDirection& held) {
    return {~std::uint64_t{0}, 3 * static_cast<std::uint64_t>(held.entry) + static_cast<std::uint64_t>(held.column)};
}

}  // namespace

ExternalWork hold_axes(const AxisHoldInputs& inputs, Real h, Real kick, Real lag, std::span<Vec3> velocity_next,
                       Column<Vec3>& held_impulse) {
    ExternalWork all, ghost_work;
    held_impulse.assign(inputs.node.size(), Vec3::Zero());
    for_each_held(inputs, h, [&](const HeldDirection& held) {
        ExternalWork& sum = inputs.ghosts.contain(inputs.body[held.node]) ? ghost_work : all;
        const Real impulse = inputs.mass[held.node] * (held.speed - held.direction.dot(velocity_next[held.node]));
        const Real gained = held.speed - held.direction.dot(inputs.velocity[held.node]);
        velocity_next[held.node] += impulse * inputs.inverse_mass[held.node] * held.direction;
        held_impulse[held.entry] += impulse * held.direction;
        sum.impulse += impulse * held.direction;
        sum.flow += std::abs(impulse);
        // Work of the holding force: the change of kinetic energy minus the work of all other forces on the node. The
        // kinetic energy changes by mass * gained * (held.speed - gained / 2). The other forces have the impulse mass *
        // gained - impulse.
        //
        // The work of the other forces is this impulse times `mean_speed`, the displacement of the node in the step
        // divided by h. In symplectic Euler it is the velocity at the end of the step. With leapfrog (lag = 0) it is
        // the mean of the velocities at the start and the end.
        const Real mean_speed = lag == 0 ? held.speed - gained / 2 : held.speed;
        sum.work += impulse * mean_speed;
        if (lag != 0) sum.work -= inputs.mass[held.node] * gained * gained / 2;
        // measure_work counts the work of gravity and loads over h instead of kick, so the difference is subtracted.
        sum.work -= (h - kick) * inputs.mass[held.node] * held.direction.dot(inputs.gravity) * mean_speed;
        if (!inputs.load.empty()) sum.work -= (h - kick) * held.direction.dot(inputs.load[held.node]) * mean_speed;
    });
    return all;
}

void prepare_held_rows(const AxisHoldInputs& inputs, const CableBlockTable& cables, Real h, ContactTable& contacts,
                       HeldRows& rows) {
    rows.entry.clear();
    rows.node.assign(inputs.mass.size(), {});
    const std::span<HeldRows::Node> node = rows.node.span();
    for_each_held(inputs, h, [&](const HeldDirection& held) {
        node[held.node].held += held.direction * held.direction.transpose();
    });
    for (std::size_t c = 0; c < contacts.size(); ++c)
        if (moves_held_nodes(inputs, contacts, c, node))
            for_each_node(contacts.stencil[c], [&](std::size_t n, Real weight) {
                node[n].in_region = true;
                node[n].impulse += weight * contacts.impulse[c];
            });
    for (const CableBlock& cable : cables.solved())
        for (const Stencil& point_stencil : rows_of(cables.stencil.span(), cable.points))
            for_each_node(point_stencil, [&](std::size_t n, Real) { node[n].in_region = true; });
    for_each_held(inputs, h, [&](const HeldDirection& held) {
        if (!node[held.node].in_region) return;
        const auto row = static_cast<Index>(held.node);
        rows.entry.push_back(static_cast<Index>(held.entry));
        append_row({.key = key_of(held),
                    .kind = ContactKind::point_collider,
                    .stencil = {{row, row, row, row}, {1, 0, 0, 0}},
                    .point = inputs.position[held.node],
                    .normal = held.direction,
                    .gap = 0,
                    .distance = 0,
                    .surface_velocity = held.speed * held.direction,
                    .static_friction = 0,
                    .dynamic_friction = infinity,
                    .restitution = 0,
                    .first_body = inputs.body[held.node],
                    .second_body = no_index,
                    .collider = no_index},
                   -held.direction.dot(node[held.node].impulse) * held.direction, contacts);
    });
}

ExternalWork take_held_rows(const AxisHoldInputs& inputs, std::span<const Vec3> velocity_next, ContactTable& contacts,
                            const HeldRows& rows, std::span<Vec3> held_impulse) {
    const std::size_t first = contacts.size() - rows.entry.size();
    ExternalWork sum;
    for (std::size_t i = 0; i < rows.entry.size(); ++i) {
        const auto entry = static_cast<std::size_t>(rows.entry[i]);
        const auto n = static_cast<std::size_t>(inputs.node[entry]);
        const Vec3& impulse = contacts.impulse[first + i];
        held_impulse[entry] += impulse;
        sum.impulse += impulse;
        sum.flow += impulse.norm();
        sum.work += impulse.dot(inputs.velocity[n] + velocity_next[n]) / 2;
    }
    contacts.resize(first);
    return sum;
}

ExternalWork hold_axes_again(const AxisHoldInputs& inputs, Real h, std::span<Vec3> velocity_next,
                             std::span<Vec3> push_out, std::span<Vec3> held_impulse) {
    ExternalWork all, ghost_work;
    for_each_held(inputs, h, [&](const HeldDirection& held) {
        ExternalWork& sum = inputs.ghosts.contain(inputs.body[held.node]) ? ghost_work : all;
        push_out[held.node] -= held.direction.dot(push_out[held.node]) * held.direction;
        const Real before = held.direction.dot(velocity_next[held.node]);
        const Real impulse = inputs.mass[held.node] * (held.speed - before);
        // The velocity is set directly. The impulse times the inverse mass would leave rounding errors, which could
        // move a node that touches a plane through the plane.
        velocity_next[held.node] += (held.speed - before) * held.direction;
        held_impulse[held.entry] += impulse * held.direction;
        sum.impulse += impulse * held.direction;
        sum.flow += std::abs(impulse);
        sum.work += impulse * (before + held.speed) / 2;
    });
    return all;
}

}  // namespace skerry
