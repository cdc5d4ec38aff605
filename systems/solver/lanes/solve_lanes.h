// Accelerated Gauss-Seidel sweeps on small regions, one region in each SIMD lane (docs/methods/region_solver.md 2, 3).
// The result of a region does not depend on the other lanes: no operation combines the numbers of different lanes, and
// solved lanes do not change.
#pragma once

#include <algorithm>

#include "systems/solver/lanes/lane_problem.h"
#include "systems/solver/methods/ags.h"

namespace skerry {

/// Largest number of sweeps in lanes. Up to this number the watchdog of solve_ags, which switches to plain sweeps if
/// there is no progress, does not act. So solve_lanes and solve_ags do the same iteration.
inline constexpr Index lane_sweep_limit = watchdog_patience;

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

/// Velocity u_i of contact i for the present impulses [m/s]
template <class T, int K>
LaneVec3<T> lane_velocity(const LaneProblem<T, K>& problem, int i) {
    LaneVec3<T> u = problem.free_velocity[i];
    for (int j = 0; j < K; ++j) u = u + problem.coupling[i][j] * problem.impulse[j];
    return u;
}

/// Lane version of project_coulomb with equal static and dynamic coefficients. NaN inputs give NaN.
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

/// Lane version of project_onto_cone.
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

/// Relative error e_nat of the present impulses in each lane (docs/methods/errors.md 2).
template <class T, int K>
T lane_error(const LaneProblem<T, K>& problem) {
    T sum{};
    for (int i = 0; i < K; ++i) {
        const LaneVec3<T> u = lane_velocity(problem, i), &normal = problem.normal[i];
        const LaneVec3<T> tangential = u - dot(normal, u) * normal;
        const LaneVec3<T> shifted = u + (problem.friction[i] * square_root(dot(tangential, tangential))) * normal;
        const LaneVec3<T> asked = project_lanes_onto_cone<T>(problem.impulse[i] - problem.inverse_diagonal[i] * shifted,
                                                             normal, problem.friction[i]);
        const LaneVec3<T> rest = problem.impulse[i] - asked;
        sum += problem.diagonal[i] * dot(rest, rest);
    }
    return square_root(sum) / problem.scale;
}

/// Does one sweep over the contacts. Lanes outside the mask `swept` keep their impulses. `previous`: impulses after the
/// last sweep, before they were extrapolated.
template <class T, int K>
SweepChangeOf<T> sweep_lanes(LaneProblem<T, K>& problem, const LaneVec3<T>* previous, const LaneMask<T>& swept,
                             Real relaxation) {
    SweepChangeOf<T> sum{};
    for (int i = 0; i < K; ++i) {
        const LaneVec3<T> before = problem.impulse[i];
        const LaneVec3<T> stopping = before - (relaxation * problem.inverse_diagonal[i]) * lane_velocity(problem, i);
        const LaneVec3<T> next =
            select<T>(swept, project_lanes<T>(stopping, problem.normal[i], problem.friction[i]), before);
        const LaneVec3<T> change = next - before;
        sum.squared_change += problem.diagonal[i] * dot(change, change);
        sum.reversal -= problem.diagonal[i] * dot(change, next - previous[i]);
        problem.impulse[i] = next;
    }
    return sum;
}

/// Lane version of a Delassus operator. It uses the dense form and stores no node velocities. Lanes outside the mask
/// `swept_` keep their impulses.
template <class T, int K>
class LaneOperator {
public:
    using Number = T;

    LaneOperator(LaneProblem<T, K>& problem, const LaneMask<T>& swept) : problem_(problem), swept_(swept) {}

    const LaneMask<T>& swept() const { return swept_; }
    void keep_sweeping(const LaneMask<T>& lanes) { swept_ = lanes; }

    SweepChangeOf<T> accelerated_sweep(Real relaxation) {
        return sweep_lanes<T, K>(problem_, previous_, swept_, relaxation);
    }
    T error() const { return lane_error<T, K>(problem_); }
    /// True if the last sweep changed the impulses so little that the error is probably within the tolerance and worth
    /// a measurement. `change`: squared change [J]. `tolerance`: one number for all lanes, or one per lane.
    LaneMask<T> suggests_check(const T& change, const auto& tolerance) const {
        return change <= (tolerance * tolerance) * (problem_.scale * problem_.scale);
    }
    void remember() { std::copy_n(problem_.impulse, K, previous_); }
    void extrapolate(const T& factor) {
        const LaneMask<T> swept = swept_;
        for (int i = 0; i < K; ++i) {
            const LaneVec3<T> now = problem_.impulse[i];
            problem_.impulse[i] = select<T>(swept, now + factor * (now - previous_[i]), now);
            previous_[i] = now;
        }
    }
    void refresh_all() {}

private:
    LaneProblem<T, K>& problem_;
    LaneVec3<T> previous_[K];
    LaneMask<T> swept_;
};

template <class T>
struct LaneOutcome {
    T iterations, error;
    LaneMask<T> solved;
};

/// Lane version of ErrorTest. The error need not be measured after the last iteration, because regions that are still
/// unsolved are solved again outside of lanes.
template <class T, int K>
class LaneTest {
public:
    LaneTest(LaneOperator<T, K>& op, const T& tolerance) : op_(op), tolerance_(tolerance) {}

    bool ends_after_sweep(Index iteration, const T& change, Index) {
        const T zero{};
        const bool all_due = iteration >= check_;
        const LaneMask<T> due =
            all_due ? op_.swept() : LaneMask<T>(op_.swept() & op_.suggests_check(change, tolerance_));
        if (!any_lane(due)) return false;
        const T error = op_.error();
        const LaneMask<T> solved = due & (error <= tolerance_);
        outcome_.solved = outcome_.solved | solved;
        outcome_.error = solved ? error : outcome_.error;
        outcome_.iterations = solved ? zero + static_cast<Real>(iteration) : outcome_.iterations;
        // A lane continues if no measurement is due, or if the measured error is finite and above the tolerance.
        op_.keep_sweeping(op_.swept() & !(due & !((error > tolerance_) & (error < zero + infinity))));
        if (!any_lane(op_.swept())) return true;
        if (all_due) check_ = next_check(iteration);
        return false;
    }
    const LaneOutcome<T>& outcome() const { return outcome_; }

private:
    LaneOperator<T, K>& op_;
    T tolerance_;
    LaneOutcome<T> outcome_{};
    Index check_ = 1;
};

/// Sweeps the `active` lanes until the error of each is within its tolerance, but at most max_iterations times. The
/// impulses of an unsolved lane must not be used.
template <class T, int K>
LaneOutcome<T> solve_lanes(LaneProblem<T, K>& problem, const LaneMask<T>& active, Index max_iterations,
                           Real relaxation) {
    static_assert(SweptOperator<LaneOperator<T, K>>);
    LaneOperator<T, K> op(problem, active);
    LaneTest<T, K> test(op, problem.tolerance);
    AcceleratedSweeps<LaneOperator<T, K>, LaneTest<T, K>> sweeps(op, test, relaxation);
    sweeps.run_to(max_iterations);
    return test.outcome();
}

}  // namespace skerry
