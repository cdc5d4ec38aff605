#include "systems/dynamics/implicit/long_step.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// Time from the start of a body's long step to the end of the present short step [s]. The last short step ends exactly
/// at times.length in spite of rounding errors.
Real time_at_end(const LongStep& step, const ImplicitTimes& times) {
    constexpr Real rounding = 1e-9;
    const Real time = step.done + times.h;
    return std::abs(time - times.length) < rounding * times.length ? times.length : time;
}

/// Computes the quantities of a long step that depend only on the state at the start of the long step. Returns false if
/// the matrix of the long step cannot be factored.
bool begin_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                     const ImplicitTimes& times, StiffBody& stiff, std::span<Vec3> elastic_force,
                     std::span<Vec3> impulse) {
    const BodyRows body(bodies, stiff, r);
    LongStep& step = stiff.long_step;
    step.resize(body.count);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement), velocity = body.rows(bodies.velocity),
                                left = body.rows(bodies.left);
    for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = displacement[n];
    body.stiff.elastic_forces(impulse, elastic_force);
    add_up_impulses(bodies, loads, r, times.theta * times.length, elastic_force, body, impulse);
    if (!make_factor(bodies, r, times.length, times.theta, stiff)) return false;
    step.elastic = 0;
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        step.start[n] = displacement[n];
        step.start_velocity[n] = velocity[n];
        step.start_force[n] = elastic_force[k];
        step.impulse[n] = impulse[k];
        step.assumed_velocity[n] = left[n] / times.length;
        step.elastic += displacement[n].dot(elastic_force[k]) / 2;
    }
    body.stiff.respond(impulse);
    for (std::size_t n = 0; n < body.count; ++n) step.free_velocity[n] = impulse[body.order_index(n)];
    std::ranges::fill(step.contact_velocity, Vec3::Zero());
    std::ranges::fill(step.assumed_impulse, Vec3::Zero());
    if (std::ranges::all_of(left, [](const Vec3& of_node) { return of_node.isZero(0); })) return true;
    // step.assumed_impulse: impulses that cause the velocities step.assumed_velocity. They are the product of these
    // velocities with the matrix A = inertia M + theta_h^2 K of the long step, with the masses M and the stiffness K.
    const Real theta_h = times.theta * times.length, inertia = inertia_of(bodies, r, theta_h);
    for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = step.assumed_velocity[n];
    body.stiff.elastic_forces(impulse, elastic_force);
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        step.assumed_impulse[n] =
            inertia * stiff.mass(k) * step.assumed_velocity[n] + theta_h * theta_h * elastic_force[k];
    }
    return true;
}

}  // namespace

bool takes_long_steps(const ImplicitBodies& bodies, const ImplicitTimes& times, std::size_t r) {
    return times.length > 0 && !bodies.holds.hold(r) && bodies.large[r] == 0;
}

bool kick_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                       const ImplicitTimes& times, StiffBody& stiff, std::span<Vec3> elastic_force,
                       std::span<Vec3> out) {
    LongStep& step = stiff.long_step;
    if (step.done == 0) {
        if (!begin_long_step(bodies, loads, r, times, stiff, elastic_force, out)) return false;
    } else if (!make_factor(bodies, r, times.length, times.theta, stiff)) {
        return false;
    }
    const BodyRows body(bodies, stiff, r);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement);
    const Real time = time_at_end(step, times), remaining_share = 1 - time / times.length;
    step.response_factor = time / times.h;
    step.asleep = false;
    for (std::size_t n = 0; n < body.count; ++n) {
        const Vec3 during =
            step.free_velocity[n] + step.contact_velocity[n] + remaining_share * step.assumed_velocity[n];
        out[body.order_index(n)] = (time * during - (displacement[n] - step.start[n])) / times.h;
    }
    return true;
}

void rest_in_long_step(const ImplicitTimes& times, StiffBody& stiff) {
    stiff.long_step.done = 0;
    stiff.long_step.response_factor = times.length > 0 ? 1 : 0;
    stiff.long_step.asleep = true;
}

Real strain_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                         const ImplicitTimes& times, StiffBody& stiff, std::span<const Vec3> contact_velocity,
                         const ImplicitStrains& out) {
    const BodyRows body(bodies, stiff, r);
    LongStep& step = stiff.long_step;
    const std::span<Vec3> next = body.rows(out.velocity_next), displacement_next = body.rows(out.displacement_next);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement), velocity = body.rows(bodies.velocity),
                                contact = body.rows(out.contact_impulse);
    const Mat3 to_mesh = bodies.turn(r).transpose();
    const Real time = time_at_end(step, times), share = time / times.length, remaining_share = 1 - share;
    const Real theta_h = times.theta * times.length, inertia = inertia_of(bodies, r, theta_h);
    Real damped = 0;    // reported work of contacts and loads minus the growth of energy [J]
    Real at_start = 0;  // rate of change of the elastic energy at the start of the long step [W]
    Real impulse_energy = 0, inertia_energy = 0;  // [J]
    for (std::size_t n = 0; n < body.count; ++n) {
        const Real mass = body.stiff.mass(body.order_index(n));
        const Vec3 impulse = to_mesh * contact[n];
        step.contact_velocity_next[n] = step.contact_velocity[n] + contact_velocity[body.order_index(n)];
        step.contact_impulse_next[n] = step.contact_impulse[n] + impulse;
        const Vec3 during = step.free_velocity[n] + step.contact_velocity_next[n] +
                            remaining_share * step.assumed_velocity[n],
                   before = velocity[n];
        displacement_next[n] = step.start[n] + time * during;
        const Vec3 rate = (displacement_next[n] - displacement[n]) / times.h,
                   after = step.start_velocity[n] + share / times.theta * (during - step.start_velocity[n]);
        damped += impulse.dot(before + rate) / 2;
        if (!loads.load.empty()) {
            const Vec3 load = to_mesh * loads.load[body.first_node + n];
            damped += times.h * load.dot(rate - (after - before) / 2) + (loads.kick - times.h) * load.dot(before);
        }
        damped -= mass / 2 * (after - before).dot(after + before);
        at_start += during.dot(step.start_force[n]);
        impulse_energy += during.dot(step.impulse[n] + times.theta * step.contact_impulse_next[n] +
                                     remaining_share * step.assumed_impulse[n]);
        inertia_energy += inertia * mass * during.squaredNorm();
        next[n] = after;
    }
    // Elastic energy u.K u / 2 with the stiffness K at the displacements u = step.start + time v, where v is `during`.
    // A = inertia M + theta_h^2 K, with the masses M, is the matrix of the long step, and A v the known impulse. So
    //     v.K v = (v.A v - inertia v.M v) / theta_h^2
    step.elastic_next = 0;
    for (std::size_t n = 0; n < body.count; ++n) step.elastic_next += step.start[n].dot(step.start_force[n]) / 2;
    step.elastic_next += time * at_start + time * time / 2 * (impulse_energy - inertia_energy) / (theta_h * theta_h);
    return damped - (step.elastic_next - step.elastic);
}

void carry_long_steps(const ImplicitTimes& times, std::span<const Index> body, std::span<const Range> body_implicit,
                      StiffBodies& stiff, std::span<Vec3> left) {
    for (std::size_t r = 0; r < body.size(); ++r) {
        const Range rows = body_implicit[static_cast<std::size_t>(body[r])];
        if (rows.size() == 0) continue;
        LongStep& step = stiff[r].long_step;
        if (step.asleep) continue;
        const std::span<Vec3> body_displacement =
            left.subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
        if (!(step.response_factor > 0)) {
            step.done = 0;
            std::ranges::fill(body_displacement, Vec3::Zero());
            continue;
        }
        step.done = time_at_end(step, times);
        step.elastic = step.elastic_next;
        step.contact_velocity.swap(step.contact_velocity_next);
        step.contact_impulse.swap(step.contact_impulse_next);
        if (!times.ends) continue;
        // Writes the displacements that the contacts would have caused in a complete long step [m]. The next long step
        // starts with them as its guess. step.contact_velocity contains only the contacts in the elapsed time
        // step.done, and the factor times.length / step.done extends it to a complete long step.
        for (std::size_t n = 0; n < body_displacement.size(); ++n)
            body_displacement[n] = times.length * (times.length / step.done) * step.contact_velocity[n];
    }
}

}  // namespace skerry
