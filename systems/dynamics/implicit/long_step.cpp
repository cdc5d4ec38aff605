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
    const OfBody of(bodies, stiff, r);
    LongStep& step = stiff.long_step;
    step.resize(of.count);
    const std::span<const Vec3> displacement = of.rows(bodies.displacement), velocity = of.rows(bodies.velocity),
                                left = of.rows(bodies.left);
    for (std::size_t n = 0; n < of.count; ++n) impulse[of.place(n)] = displacement[n];
    of.stiff.elastic_forces(impulse, elastic_force);
    add_up_impulses(bodies, loads, r, times.theta * times.length, elastic_force, of, impulse);
    if (!make_factor(bodies, r, times.length, times.theta, stiff)) return false;
    step.elastic = 0;
    for (std::size_t n = 0; n < of.count; ++n) {
        const std::size_t k = of.place(n);
        step.start[n] = displacement[n];
        step.start_velocity[n] = velocity[n];
        step.start_force[n] = elastic_force[k];
        step.impulse[n] = impulse[k];
        step.left[n] = left[n] / times.length;
        step.elastic += displacement[n].dot(elastic_force[k]) / 2;
    }
    of.stiff.respond(impulse);
    for (std::size_t n = 0; n < of.count; ++n) step.free[n] = impulse[of.place(n)];
    std::ranges::fill(step.answer, Vec3::Zero());
    std::ranges::fill(step.left_impulse, Vec3::Zero());
    if (std::ranges::all_of(left, [](const Vec3& of_node) { return of_node.isZero(0); })) return true;
    // Impulses that cause the velocities step.left: the product A step.left with the matrix A of the long step.
    const Real within = times.theta * times.length, inertia = inertia_of(bodies, r, within);
    for (std::size_t n = 0; n < of.count; ++n) impulse[of.place(n)] = step.left[n];
    of.stiff.elastic_forces(impulse, elastic_force);
    for (std::size_t n = 0; n < of.count; ++n) {
        const std::size_t k = of.place(n);
        step.left_impulse[n] = inertia * stiff.mass(k) * step.left[n] + within * within * elastic_force[k];
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
    const OfBody of(bodies, stiff, r);
    const std::span<const Vec3> displacement = of.rows(bodies.displacement);
    const Real time = time_at_end(step, times), still_left = 1 - time / times.length;
    step.weight = time / times.h;
    step.rests = false;
    for (std::size_t n = 0; n < of.count; ++n) {
        const Vec3 during = step.free[n] + step.answer[n] + still_left * step.left[n];
        out[of.place(n)] = (time * during - (displacement[n] - step.start[n])) / times.h;
    }
    return true;
}

void rest_in_long_step(const ImplicitTimes& times, StiffBody& stiff) {
    stiff.long_step.done = 0;
    stiff.long_step.weight = times.length > 0 ? 1 : 0;
    stiff.long_step.rests = true;
}

Real strain_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                         const ImplicitTimes& times, StiffBody& stiff, std::span<const Vec3> given,
                         const ImplicitStrains& out) {
    const OfBody of(bodies, stiff, r);
    LongStep& step = stiff.long_step;
    const std::span<Vec3> next = of.rows(out.velocity_next), displacement_next = of.rows(out.displacement_next);
    const std::span<const Vec3> displacement = of.rows(bodies.displacement), velocity = of.rows(bodies.velocity),
                                contact = of.rows(out.contact_impulse);
    const Mat3 back = bodies.turn(r).transpose();
    const Real time = time_at_end(step, times), share = time / times.length, still_left = 1 - share;
    const Real within = times.theta * times.length, inertia = inertia_of(bodies, r, within);
    Real taken = 0;                        // reported work of contacts and loads minus the growth of energy [J]
    Real at_start = 0;                     // rate of change of the elastic energy at the start of the long step [W]
    Real of_impulses = 0, of_inertia = 0;  // [J]
    for (std::size_t n = 0; n < of.count; ++n) {
        const Real mass = of.stiff.mass(of.place(n));
        const Vec3 impulse = back * contact[n];
        step.answer_next[n] = step.answer[n] + given[of.place(n)];
        step.contact_next[n] = step.contact[n] + impulse;
        const Vec3 during = step.free[n] + step.answer_next[n] + still_left * step.left[n], before = velocity[n];
        displacement_next[n] = step.start[n] + time * during;
        const Vec3 rate = (displacement_next[n] - displacement[n]) / times.h,
                   after = step.start_velocity[n] + share / times.theta * (during - step.start_velocity[n]);
        taken += impulse.dot(before + rate) / 2;
        if (!loads.load.empty()) {
            const Vec3 load = back * loads.load[of.first_node + n];
            taken += times.h * load.dot(rate - (after - before) / 2) + (loads.kick - times.h) * load.dot(before);
        }
        taken -= mass / 2 * (after - before).dot(after + before);
        at_start += during.dot(step.start_force[n]);
        of_impulses +=
            during.dot(step.impulse[n] + times.theta * step.contact_next[n] + still_left * step.left_impulse[n]);
        of_inertia += inertia * mass * during.squaredNorm();
        next[n] = after;
    }
    // Elastic energy u.K u / 2 at the displacements u = step.start + time v, with the velocity v = `during` and the
    // stiffness K. The product K v follows from A v, where A is the matrix of the long step and A v are the known
    // impulses.
    step.elastic_next = 0;
    for (std::size_t n = 0; n < of.count; ++n) step.elastic_next += step.start[n].dot(step.start_force[n]) / 2;
    step.elastic_next += time * at_start + time * time / 2 * (of_impulses - of_inertia) / (within * within);
    return taken - (step.elastic_next - step.elastic);
}

void carry_long_steps(const ImplicitTimes& times, std::span<const Index> body, std::span<const Range> body_implicit,
                      StiffBodies& stiff, std::span<Vec3> left) {
    for (std::size_t r = 0; r < body.size(); ++r) {
        const Range rows = body_implicit[static_cast<std::size_t>(body[r])];
        if (rows.size() == 0) continue;
        LongStep& step = stiff[r].long_step;
        if (step.rests) continue;
        const std::span<Vec3> of_body =
            left.subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
        if (!(step.weight > 0)) {
            step.done = 0;
            std::ranges::fill(of_body, Vec3::Zero());
            continue;
        }
        step.done = time_at_end(step, times);
        step.elastic = step.elastic_next;
        step.answer.swap(step.answer_next);
        step.contact.swap(step.contact_next);
        if (!times.ends) continue;
        // `left` is the length of a long step times the velocity that contacts would have caused in a complete long
        // step. The next long step assumes this velocity at first. step.answer covers only the time step.done, hence
        // the factor times.length / step.done.
        for (std::size_t n = 0; n < of_body.size(); ++n)
            of_body[n] = times.length * (times.length / step.done) * step.answer[n];
    }
}

}  // namespace skerry
