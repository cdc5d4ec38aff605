#include "systems/contact/measure_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/contact/tangent_frame.h"

namespace skerry {
namespace {

Vec3 relative_velocity(const Stencil& stencil, const Vec3& surface_velocity, std::span<const Vec3> velocity) {
    Vec3 sum = -surface_velocity;
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0) sum += stencil.weight[a] * velocity[stencil.node[a]];
    return sum;
}

/// Size of the tangential impulse, to be compared with the coefficient of friction times the normal impulse:
/// - friction cone: the length of the tangential impulse;
/// - friction pyramid: the larger of its two components;
/// - friction axis: its length after the component perpendicular to the axis is divided by `across`, the factor of the
///   coefficient of friction in that direction.
Real tangential_load(const Vec3& tangential, const Vec3& normal, const FrictionAxis& axis, Friction friction) {
    if (axis.across != 1) {
        const Real along = tangential.dot(axis.direction);
        return std::hypot(along, (tangential - along * axis.direction).norm() / axis.across);
    }
    if (friction != Friction::pyramid) return tangential.norm();
    const TangentFrame frame = tangent_frame(normal);
    return std::max(std::abs(tangential.dot(frame.first)), std::abs(tangential.dot(frame.second)));
}

ContactState state_of(const ContactTable& contacts, std::size_t i, Friction friction) {
    const Vec3 &impulse = contacts.impulse[i], &normal = contacts.normal[i];
    const Real along = impulse.dot(normal);
    if (!(along > 0)) return ContactState::open;
    // The impulse of a sliding contact is on the limit of dynamic friction up to rounding, because the solver puts it
    // there. If the solver accepts the impulse of the last step (warm start), it is also there: it has only been
    // rotated with the normal.
    constexpr Real rounding = 1e-9;
    const Real load = tangential_load(impulse - along * normal, normal, contacts.friction_axis[i], friction);
    const Real limit = contacts.dynamic_friction[i] * along;
    const bool on_limit =
        std::abs(load - limit) <= rounding * limit || load >= contacts.static_friction[i] * along * (1 - rounding);
    return on_limit ? ContactState::slide : ContactState::stick;
}

/// Adds the impulse and work that the moving nodes of a contact receive from the surface of a collider and from nodes
/// that no impulse can move.
void add_outer(const Stencil& stencil, const Vec3& surface_velocity, const Vec3& impulse,
               std::span<const Real> inverse_mass, std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
               ContactMeasures& sum) {
    Real moving = 0;  // sum of the weights of the moving nodes
    Vec3 outer_velocity = surface_velocity;
    for (std::size_t a = 0; a < 4; ++a) {
        const Index node = stencil.node[a];
        if (stencil.weight[a] == 0) continue;
        if (inverse_mass[node] > 0)
            moving += stencil.weight[a];
        else
            outer_velocity -= stencil.weight[a] / 2 * (velocity[node] + velocity_next[node]);
    }
    sum.outer_impulse += moving * impulse;
    sum.outer_work += impulse.dot(outer_velocity);
}

void add(ContactMeasures& sum, const ContactMeasures& part) {
    sum.max_penetration = std::max(sum.max_penetration, part.max_penetration);
    sum.max_gap_violation = std::max(sum.max_gap_violation, part.max_gap_violation);
    sum.dissipated += part.dissipated;
    sum.outer_impulse += part.outer_impulse;
    sum.outer_work += part.outer_work;
    sum.stick_count += part.stick_count;
    sum.slide_count += part.slide_count;
}

}  // namespace

ContactMeasures measure_contacts(Executor& executor, const ContactTable& contacts, std::span<const Real> inverse_mass,
                                 std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                                 const RoundSpins& spins, std::span<Vec3> slip, std::span<ContactState> state,
                                 Friction friction) {
    const std::size_t count = contacts.size();
    const TouchPoints touch_points{contacts.point.span(), contacts.distance.span()};
    SKERRY_CHECK(slip.size() == count && state.size() == count);
    // The contacts are divided into a limited number of parts, so that the sums over each part need no allocation. The
    // borders of the parts, and thus the bits of the sums, depend only on the number of contacts.
    constexpr std::size_t part_limit = 64, smallest_part = 128;
    const std::size_t part_size = std::max(smallest_part, (count + part_limit - 1) / part_limit);
    std::array<ContactMeasures, part_limit> parts{};
    parallel_for(executor, count, part_size, [&](std::size_t begin, std::size_t end) {
        ContactMeasures& part = parts[begin / part_size];
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& normal = contacts.normal[i];
            const Vec3& impulse = contacts.impulse[i];
            const Stencil& stencil = contacts.stencil[i];
            const Vec3 after =
                relative_velocity(stencil, contacts.surface_velocity[i], velocity_next) +
                spins.nodes.rolling(stencil, i, normal, touch_points, [&](std::size_t r) { return spins.after(r); });
            slip[i] = after - after.dot(normal) * normal;
            state[i] = state_of(contacts, i, friction);
            part.max_penetration = std::max(part.max_penetration, -contacts.distance[i]);
            part.max_gap_violation = std::max(part.max_gap_violation, -contacts.gap[i]);
            part.stick_count += state[i] == ContactState::stick;
            part.slide_count += state[i] == ContactState::slide;
            if (state[i] == ContactState::open) continue;
            const Vec3 before =
                relative_velocity(stencil, contacts.surface_velocity[i], velocity) +
                spins.nodes.rolling(stencil, i, normal, touch_points, [&](std::size_t r) { return spins.before(r); });
            part.dissipated -= 0.5 * impulse.dot(before + after);
            add_outer(stencil, contacts.surface_velocity[i], impulse, inverse_mass, velocity, velocity_next, part);
        }
    });
    ContactMeasures total;
    for (const ContactMeasures& part : parts) add(total, part);
    return total;
}

}  // namespace skerry
