#include "systems/dynamics/implicit/move_implicit_bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "jobs/parallel_for.h"
#include "systems/dynamics/implicit/body_rows.h"
#include "systems/dynamics/implicit/free_large_step.h"
#include "systems/dynamics/implicit/held_implicit_body.h"
#include "systems/dynamics/implicit/long_step.h"

namespace skerry {

namespace {

void for_each_implicit(Executor& executor, const ImplicitBodies& bodies, auto&& visit) {
    parallel_for(executor, bodies.body.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r)
            if (bodies.rows(r).size() > 0) visit(r);
    });
}

/// True if a step of length `h` [s] with these velocities leads from small to large strain. `displacement`: by node;
/// `velocity`: by index in the elimination order.
bool becomes_large(std::span<const Vec3> displacement, std::span<const Vec3> velocity, const Vec3& angular_momentum,
                   Real h, const BodyRows& body, StiffBody& stiff) {
    if (!stiff.elements().any_nonlinear()) return false;
    std::vector<Vec3>& at_end = stiff.large_step.displacement_in_step;
    at_end.resize(body.count);
    for (std::size_t n = 0; n < body.count; ++n)
        at_end[body.order_index(n)] = displacement[n] + h * velocity[body.order_index(n)];
    return stiff.becomes_large_in_order(at_end, angular_momentum);
}

/// Copies the present moments, axes, rotations and strain flags of all bodies to the columns for the end of the step.
/// Steps at large strain then overwrite these values; other bodies keep them.
void keep_spins(const ImplicitBodies& bodies, const ImplicitSpins& spins, const ImplicitStrains& out) {
    std::ranges::copy(bodies.large, out.large_next.begin());
    std::ranges::copy(spins.moments, out.moments_next.begin());
    std::ranges::copy(bodies.axes, out.axes_next.begin());
    std::ranges::copy(bodies.rotation, out.rotation_shaped.begin());
}

}  // namespace

void add_up_impulses(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real theta_h,
                     std::span<const Vec3> force, const BodyRows& body, std::span<Vec3> impulse) {
    const std::span<const Vec3> velocity = body.rows(bodies.velocity);
    const Mat3 turn = bodies.turn(r);
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        impulse[k] = body.stiff.mass(k) * velocity[n];
        impulse[k] -= theta_h * force[k];
        if (!loads.load.empty()) impulse[k] += theta_h * (turn.transpose() * loads.load[body.first_node + n]);
    }
}

Real inertia_of(const ImplicitBodies& bodies, std::size_t r, Real theta_h) {
    return 1 + theta_h * bodies.damping(r);
}

bool is_large_after(bool was_large, std::span<const Vec3> displacement, const Vec3& angular_momentum,
                    const BodyRows& body, StiffBody& stiff) {
    if (was_large || stiff.is_tangent()) return !stiff.becomes_small(displacement, angular_momentum);
    if (!stiff.elements().any_nonlinear()) return false;
    std::vector<Vec3>& at_end = stiff.large_step.displacement_in_step;
    at_end.resize(body.count);
    for (std::size_t n = 0; n < body.count; ++n) at_end[body.order_index(n)] = displacement[n];
    return stiff.becomes_large_in_order(at_end, angular_momentum);
}

bool make_factor(const ImplicitBodies& bodies, std::size_t r, Real h, Real theta, StiffBody& stiff) {
    // The step length is rounded to about twelve digits (40 bits). Steps that divide a time interval evenly differ only
    // in later digits, and so share one matrix factor.
    constexpr int bits = 40;
    int exponent = 0;
    const Real fraction = std::frexp(h, &exponent);
    const Real rounded = std::ldexp(std::nearbyint(std::ldexp(fraction, bits)), exponent - bits);
    const Real theta_h = theta * rounded;
    return stiff.prepare(inertia_of(bodies, r, theta_h), theta_h * theta_h);
}

bool kick_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                          const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                          const ImplicitKicks& out) {
    if (!bodies.any()) return false;
    const Real h = times.h, theta = times.theta;
    for_each_implicit(executor, bodies, [&](std::size_t r) {
        const BodyRows body(bodies, stiff[r], r);
        const std::span<Vec3> next = body.rows(out.velocity_next);
        std::ranges::fill(body.rows(out.contact_impulse), Vec3::Zero());
        std::ranges::fill(next, Vec3::Zero());
        stiff[r].forget_tangent();
        stiff[r].large_step.counts = {};
        stiff[r].large_step.failed = false;
        stiff[r].long_step.response_factor = 0;
        stiff[r].long_step.asleep = false;
        if (times.starts) stiff[r].long_step.done = 0;
        if (bodies.asleep(r)) {
            rest_in_long_step(times, stiff[r]);
            return;
        }
        if (bodies.holds.hold(r)) {
            kick_held_body(bodies, loads, r, h, theta, stiff[r], out);
            return;
        }
        const std::span<Vec3> impulse = body.rows(out.impulse), force = body.rows(out.elastic_force);
        const std::span<const Vec3> displacement = body.rows(bodies.displacement);
        bool large = bodies.large[r] != 0, sound = true;
        if (takes_long_steps(bodies, times, r)) {
            sound = kick_in_long_step(bodies, loads, r, times, stiff[r], force, impulse);
        } else if (!large) {
            for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = displacement[n];
            body.stiff.elastic_forces(impulse, force);
            add_up_impulses(bodies, loads, r, theta * h, force, body, impulse);
            sound = make_factor(bodies, r, h, theta, stiff[r]);
            if (sound) body.stiff.respond(impulse);
        }
        large = large || (sound && becomes_large(displacement, impulse, bodies.turn(r).transpose() * spins.kicked(r), h,
                                                 body, stiff[r]));
        if (large) stiff[r].long_step.response_factor = 0;
        if (large) sound = kick_large_free_body(bodies, loads, spins, r, h, theta, stiff[r], impulse);
        if (!sound)  // velocities of NaN make the engine refuse the step
            std::ranges::fill(impulse, Vec3::Constant(std::numeric_limits<Real>::quiet_NaN()));
        const Mat3 turn = bodies.turn(r);
        for (std::size_t n = 0; n < body.count; ++n) {
            next[n] = impulse[body.order_index(n)];
            out.node_velocity_next[body.first_node + n] += turn * next[n];
        }
    });
    return true;
}

bool couple_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const TouchedNodes& stencils,
                            std::span<const Index> node_body, const ImplicitTimes& times, StiffBodies& stiff,
                            ImplicitCoupling& coupling) {
    coupling.nodes.clear();
    if (!bodies.any()) return false;
    constexpr Index any_contact = 0;
    coupling.touched_index.assign(bodies.displacement.size(), no_index);
    bool any = false;
    for (const std::span<const Stencil> list : {stencils.contact, stencils.cable_point})
        for (const Stencil& stencil : list)
            for (std::size_t a = 0; a < 4; ++a) {
                if (stencil.weight[a] == 0) continue;
                const Index node = stencil.node[a];
                const auto body = static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)]);
                const Range rows = bodies.body_implicit[body];
                if (rows.size() == 0) continue;
                coupling.touched_index[static_cast<std::size_t>(rows.begin + node - bodies.body_nodes[body].begin)] =
                    any_contact;
                any = true;
            }
    if (!any) return false;
    coupling.nodes.offset.push_back(0);
    for (std::size_t r = 0; r < bodies.body.size(); ++r) {
        Index count = 0;
        for (Index row = bodies.rows(r).begin; row < bodies.rows(r).end; ++row) {
            Index& local = coupling.touched_index[static_cast<std::size_t>(row)];
            if (local == no_index) continue;
            local = count++;
            coupling.nodes.item.push_back(bodies.nodes(r).begin + row - bodies.rows(r).begin);
        }
        coupling.nodes.offset.push_back(static_cast<Index>(coupling.nodes.item.size()));
    }
    coupling.response.resize(bodies.body.size());
    coupling.turn.resize(bodies.body.size());
    coupling.impulse_turn.resize(bodies.body.size());
    for_each_implicit(executor, bodies, [&](std::size_t r) {
        const std::span<const Index> nodes = coupling.nodes[r];
        if (nodes.empty()) return;
        const Real weight = stiff[r].long_step.response_factor;
        if (!stiff[r].is_tangent()) make_factor(bodies, r, weight > 0 ? times.length : times.h, times.theta, stiff[r]);
        coupling.turn[r] = bodies.holds.hold(r) ? HeldFrame(bodies, r, times.h).turn : bodies.turn(r);
        coupling.impulse_turn[r] = (weight > 0 ? weight * times.theta : times.theta) * coupling.turn[r].transpose();
        coupling.response[r] = stiff[r].responses(nodes, bodies.nodes(r).begin);
    });
    return true;
}

namespace {

/// Computes StrainPart::impulse for one body.
Vec3 impulse_of_longer_step(const ImplicitLoads& loads, Real h, const BodyRows& body) {
    Vec3 force = Vec3::Zero();
    for (std::size_t n = 0; n < body.count; ++n) {
        force += body.stiff.mass(body.order_index(n)) * loads.gravity;
        if (!loads.load.empty()) force += loads.load[body.first_node + n];
    }
    return (h - loads.kick) * force;
}

}  // namespace

StrainFindings strain_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                                      const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                                      const ImplicitStrains& out, Column<StrainPart>& parts) {
    if (!bodies.any()) return {};
    const Real h = times.h, theta = times.theta;
    parts.assign(bodies.body.size(), {});
    keep_spins(bodies, spins, out);
    for_each_implicit(executor, bodies, [&](std::size_t r) {
        const BodyRows body(bodies, stiff[r], r);
        if (h != loads.kick && !bodies.asleep(r)) parts[r].impulse = impulse_of_longer_step(loads, h, body);
        if (bodies.holds.hold(r)) {
            parts[r].damped = strain_held_body(bodies, r, h, loads.kick, theta, stiff[r], out);
            return;
        }
        const std::span<Vec3> impulse = body.rows(out.impulse), rate = body.rows(out.force_rate),
                              next = body.rows(out.velocity_next), displacement_next = body.rows(out.displacement_next);
        const std::span<const Vec3> displacement = body.rows(bodies.displacement),
                                    velocity = body.rows(bodies.velocity), force = body.rows(out.elastic_force),
                                    contact = body.rows(out.contact_impulse);
        const bool any_contact = std::ranges::any_of(contact, [](const Vec3& of_node) { return !of_node.isZero(0); });
        const Mat3 to_mesh = bodies.turn(r).transpose();
        if (any_contact) {
            for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = theta * (to_mesh * contact[n]);
            body.stiff.respond(impulse);
        }
        if (stiff[r].long_step.response_factor > 0 && !bodies.asleep(r)) {
            if (!any_contact) std::ranges::fill(impulse, Vec3::Zero());
            parts[r].damped = strain_in_long_step(bodies, loads, r, times, stiff[r], impulse, out);
            if (is_large_after(false, displacement_next, to_mesh * spins.after(r), body, stiff[r]))
                parts[r].damped += become_large(bodies, spins, r, h, stiff[r], out);
            return;
        }
        if (any_contact)
            for (std::size_t n = 0; n < body.count; ++n) next[n] += impulse[body.order_index(n)];
        for (std::size_t n = 0; n < body.count; ++n) displacement_next[n] = displacement[n] + h * next[n];
        if (bodies.asleep(r)) return;
        if (bodies.large[r] != 0 || stiff[r].is_tangent() ||
            is_large_after(false, displacement_next, to_mesh * spins.after(r), body, stiff[r])) {
            parts[r].damped = end_large_free_step(bodies, loads, spins, r, h, theta, stiff[r], out);
            return;
        }
        for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = next[n];
        body.stiff.elastic_forces(impulse, rate);
        Real damped = 0;
        for (std::size_t n = 0; n < body.count; ++n) {
            const std::size_t k = body.order_index(n);
            const Vec3 &before = velocity[n], &during = next[n];
            const Vec3 after = before + (during - before) / theta;
            // `damped`: reported work of contacts and loads minus the growth of kinetic and elastic energy [J].
            damped += (to_mesh * contact[n]).dot(before + during) / 2;
            if (!loads.load.empty()) {
                const Vec3 load = to_mesh * loads.load[body.first_node + n];
                // Work of the load as the reported energy balance counts it [J]: the work over the displacement of the
                // step, corrected because reported velocities belong to a slightly different time than positions.
                damped += h * load.dot(during - (after - before) / 2) + (loads.kick - h) * load.dot(before);
            }
            damped -= body.stiff.mass(k) / 2 * (after - before).dot(after + before);
            damped -= h * during.dot(force[k] + h / 2 * rate[k]);
            next[n] = after;
        }
        parts[r].damped = damped;
    });
    StrainFindings found;
    for (std::size_t r = 0; r < parts.size(); ++r) {
        if (bodies.ghosts.contain(bodies.body[r])) continue;
        found.damped += parts[r].damped;
        found.impulse += parts[r].impulse;
    }
    for (std::size_t r = 0; r < stiff.size(); ++r) {
        if (!bodies.ghosts.contain(bodies.body[r])) found.newton += stiff[r].large_step.counts;
        if (found.unsolved == no_index && stiff[r].large_step.failed) found.unsolved = bodies.body[r];
    }
    return found;
}

void drift_implicit_bodies(const ImplicitBodies& bodies, const ImplicitSpins& spins, StiffBodies& stiff, Real seconds,
                           const ImplicitStrains& out) {
    if (!bodies.any()) return;
    keep_spins(bodies, spins, out);
    const std::span<Vec3> displacement_next = out.displacement_next, velocity_next = out.velocity_next;
    for (std::size_t r = 0; r < bodies.body.size(); ++r) {
        const Range rows = bodies.rows(r);
        if (rows.size() > 0 && bodies.holds.hold(r)) {
            drift_held_body(bodies, r, seconds, displacement_next, velocity_next);
            continue;
        }
        for (auto row = static_cast<std::size_t>(rows.begin); row < static_cast<std::size_t>(rows.end); ++row) {
            displacement_next[row] = bodies.displacement[row] + seconds * bodies.velocity[row];
            velocity_next[row] = bodies.velocity[row];
        }
        if (bodies.large[r] != 0 && !bodies.asleep(r))
            follow_shape(BodyRows(bodies, stiff[r], r).rows(displacement_next), true, bodies.turn(r), stiff[r],
                         out.moments_next[r], out.axes_next[r], out.rotation_shaped[r]);
    }
}

}  // namespace skerry
