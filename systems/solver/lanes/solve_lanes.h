// Accelerated Gauss-Seidel on regions side by side: methods.md 2.4 in the dense form, every lane on its own. No operation goes across
// lanes and a lane that is solved stands still, so a region's result does not depend on what the other lanes hold.
#pragma once

#include <limits>

#include "systems/solver/lanes/lane_problem.h"

namespace skerry {

/// The watchdog of solve_ags does not bark before: until then the two are the same iteration.
inline constexpr Index lane_sweep_limit = 60;

template <class T>
using LaneMask = decltype(T{} < T{});

inline bool any_lane(bool mask) {
    return mask;
}
template <class Mask>
bool any_lane(const Mask& mask) {
    auto either = mask[0];
    for (int l = 1; l < element_lanes; ++l) either |= mask[l];
    return either != 0;
}

template <class T>
LaneVec3<T> select(const LaneMask<T>& mask, const LaneVec3<T>& a, const LaneVec3<T>& b) {
    return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
template <class T>
T larger(const T& a, const T& b) {
    return a > b ? a : b;
}

/// u_i of the present impulse.
template <class T, int K>
LaneVec3<T> lane_velocity(const LaneProblem<T, K>& problem, int i) {
    LaneVec3<T> u = problem.free_velocity[i];
    for (int j = 0; j < K; ++j) u = u + problem.coupling[i][j] * problem.impulse[j];
    return u;
}

/// project_coulomb with one coefficient. Not-a-number stays not-a-number.
template <class T>
LaneVec3<T> project_lanes(const LaneVec3<T>& z, const LaneVec3<T>& normal, const T& mu) {
    const T zero{};
    const T along = dot(normal, z);
    const LaneVec3<T> pressed = along * normal;
    const LaneVec3<T> tangential = z - pressed;
    const T length_squared = dot(tangential, tangential), limit = mu * along;
    const LaneVec3<T> cut = pressed + (limit / square_root(length_squared)) * tangential;
    const LaneVec3<T> kept = select<T>(length_squared <= limit * limit, z, cut);
    return select<T>(along <= zero, {zero, zero, zero}, kept);
}

/// project_onto_cone.
template <class T>
LaneVec3<T> project_lanes_onto_cone(const LaneVec3<T>& z, const LaneVec3<T>& normal, const T& mu) {
    const T zero{};
    const T along = dot(normal, z);
    const LaneVec3<T> tangential = z - along * normal;
    const T length = square_root(dot(tangential, tangential));
    const T nearest = (along + mu * length) / (1 + mu * mu);
    const T share = length == zero ? zero : mu * nearest / length;
    const LaneVec3<T> cut = nearest * normal + share * tangential;
    const LaneVec3<T> inside = select<T>(length <= mu * along, z, cut);
    return select<T>(mu * length <= -along, {zero, zero, zero}, inside);
}

/// e_nat of methods.md 2.1.
template <class T, int K>
T lane_error(const LaneProblem<T, K>& problem) {
    T sum{};
    for (int i = 0; i < K; ++i) {
        const LaneVec3<T> u = lane_velocity(problem, i), &normal = problem.normal[i];
        const LaneVec3<T> tangential = u - dot(normal, u) * normal;
        const LaneVec3<T> shifted = u + (problem.friction[i] * square_root(dot(tangential, tangential))) * normal;
        const LaneVec3<T> asked =
            project_lanes_onto_cone<T>(problem.impulse[i] - problem.inverse_diagonal[i] * shifted, normal, problem.friction[i]);
        const LaneVec3<T> rest = problem.impulse[i] - asked;
        sum += problem.diagonal[i] * dot(rest, rest);
    }
    return square_root(sum) / problem.scale;
}

template <class T>
struct LaneSweep {
    T size, against;  // as SweepChange
};

/// Lanes outside of `active` keep their impulses.
template <class T, int K>
LaneSweep<T> sweep_lanes(LaneProblem<T, K>& problem, const LaneVec3<T>* previous, const LaneMask<T>& active, Real relaxation) {
    LaneSweep<T> sum{};
    for (int i = 0; i < K; ++i) {
        const LaneVec3<T> before = problem.impulse[i];
        const LaneVec3<T> stopping = before - (relaxation * problem.inverse_diagonal[i]) * lane_velocity(problem, i);
        const LaneVec3<T> next = select<T>(active, project_lanes<T>(stopping, problem.normal[i], problem.friction[i]), before);
        const LaneVec3<T> change = next - before;
        sum.size += problem.diagonal[i] * dot(change, change);
        sum.against -= problem.diagonal[i] * dot(change, next - previous[i]);
        problem.impulse[i] = next;
    }
    return sum;
}

template <class T>
struct LaneOutcome {
    T iterations, error;
    LaneMask<T> solved;
};

/// Sweeps the `active` lanes until each is solved, or for max_iterations sweeps. A lane that is not solved then has no useful impulse.
template <class T, int K>
LaneOutcome<T> solve_lanes(LaneProblem<T, K>& problem, LaneMask<T> active, Real tolerance, Index max_iterations, Real relaxation) {
    constexpr Real infinite = std::numeric_limits<Real>::infinity();
    constexpr Real guard = 2;  // as in solve_ags
    const T zero{}, one = zero + 1;
    LaneOutcome<T> outcome{zero, zero, zero > zero};
    LaneVec3<T> previous[K];
    for (int i = 0; i < K; ++i) previous[i] = problem.impulse[i];
    const T small = (tolerance * tolerance) * (problem.scale * problem.scale);
    T momentum = one, smallest_change = zero + infinite;
    Index check = 1;
    for (Index iteration = 1; iteration <= max_iterations; ++iteration) {
        const LaneSweep<T> change = sweep_lanes<T, K>(problem, previous, active, relaxation);
        const bool all_due = iteration >= check;
        const LaneMask<T> due = all_due ? active : LaneMask<T>(active & (change.size <= small));
        if (any_lane(due)) {
            const T error = lane_error<T, K>(problem);
            const LaneMask<T> solved = due & (error <= zero + tolerance);
            outcome.solved = outcome.solved | solved;
            outcome.error = solved ? error : outcome.error;
            outcome.iterations = solved ? zero + static_cast<Real>(iteration) : outcome.iterations;
            active = active & !(due & !((error > zero + tolerance) & (error < zero + infinite)));  // solved, or not finite
            if (!any_lane(active)) break;
            if (all_due) check = next_check(iteration);
        }
        const T next_momentum = (1 + square_root(T(1 + 4 * momentum * momentum))) / 2;
        smallest_change = change.size < smallest_change ? change.size : smallest_change;
        const LaneMask<T> restart = (change.against > zero) | (change.size > guard * smallest_change);
        const T extrapolation = restart ? zero : (momentum - 1) / next_momentum;
        momentum = restart ? one : next_momentum;
        smallest_change = restart ? change.size : smallest_change;
        for (int i = 0; i < K; ++i) {
            const LaneVec3<T> now = problem.impulse[i];
            problem.impulse[i] = select<T>(active, now + extrapolation * (now - previous[i]), now);
            previous[i] = now;
        }
    }
    return outcome;
}

}  // namespace skerry
