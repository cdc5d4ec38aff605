// The associated friction law (docs/methods/friction.md 1.4).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "profiling/lab/solve_problem.h"
#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/pgs.h"
#include "tests/unit/solver/dense_problem.h"

namespace skerry::test::associated_test {

namespace {

struct NamedMethod {
    const char* name;
    lab::AssociatedMethod solve;
};

const NamedMethod methods[] = {
    {"pgs", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return solve_pgs(op, limits); }},
    {"ags", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return solve_ags(op, limits); }},
    {"nncg", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return lab::solve_nncg(op, limits); }},
    {"apgd", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return lab::solve_apgd(op, limits); }},
};
const lab::AssociatedMethod& sweeps = methods[0].solve;

/// Starts from the impulses in the memory and leaves the solution there.
SolveResult solve_prepared(const DenseProblem& problem, const lab::AssociatedMethod& method, const SolveLimits& limits,
                           BlockMemory& memory) {
    lab::AssociatedOperator op(memory, problem.view(), problem.all);
    return method(op, limits);
}
SolveResult solve_dense(const DenseProblem& problem, const lab::AssociatedMethod& method, const SolveLimits& limits,
                        std::vector<Vec4>& impulse) {
    BlockMemory memory;
    memory.prepare(problem.view(), problem.all);
    const SolveResult result = solve_prepared(problem, method, limits, memory);
    impulse = memory.impulse;
    return result;
}

}  // namespace

TEST_CASE("gradients and sweeps agree on the associated law, and it is not Coulomb's", "[unit][lab]") {
    for (unsigned seed = 0; seed < 10; ++seed) {
        INFO("seed " << seed);
        const DenseProblem problem(8, 40, 0.6, seed);
        std::vector<Vec4> swept, other;
        CHECK(solve_dense(problem, sweeps, {1e-12, 50000, false, 1}, swept).converged);
        BlockMemory coulomb;
        coulomb.prepare(problem.view(), problem.all);
        BlockOperator op(coulomb, 0, 8, Friction::cone, 0);
        CHECK(solve_pgs(op, {1e-12, 50000, false, 1}).converged);
        Real difference = 0;
        for (std::size_t i = 0; i < problem.q.size(); ++i) {
            const Vec3 u = problem.velocity(i, swept), r = swept[i].head<3>();
            const Real size = 1 + problem.q[i].norm();
            // r is in the cone, u in the dual cone, and they are orthogonal. The check uses W and q alone.
            CHECK(std::hypot(r[1], r[2]) <= 0.6 * r[0] * (1 + 1e-12));
            CHECK(u[0] - 0.6 * std::hypot(u[1], u[2]) > -1e-9 * size);
            CHECK(std::abs(u.dot(r)) < 1e-9 * size);
            difference = std::max(difference, (u - problem.velocity(i, coulomb.impulse)).norm() / size);
        }
        CHECK(difference > 1e-3);
        for (const NamedMethod& method : methods) {
            INFO(method.name);
            CHECK(solve_dense(problem, method.solve, {1e-12, 50000, false, 1}, other).converged);
            for (std::size_t i = 0; i < problem.q.size(); ++i)
                CHECK((problem.velocity(i, swept) - problem.velocity(i, other)).norm() <
                      1e-8 * (1 + problem.q[i].norm()));
        }
    }
}

TEST_CASE("a contact that slides apart slowly still presses under the associated law", "[unit][lab]") {
    // A mass of 2 kg moves along x at 1 m/s and lifts off at 0.1 m/s. Components: normal, then tangents.
    DenseProblem problem(1, 3, 0.5, 1);
    problem.block = {0.5 * Mat3::Identity()};
    problem.q = {Vec3(0.1, 1, 0)};
    // The contact lifts off at mu times its speed: z = -m v, r_n = (z_n + mu |z_t|) / (1 + mu^2).
    const Real pressed = 2 * (-0.1 + 0.5) / 1.25;
    for (const bool fixed : {false, true}) {
        std::vector<Vec4> impulse;
        solve_dense(problem, sweeps, {1e-12, 3, fixed, 1}, impulse);
        // The solver stops at 1e-12; it leaves 2e-14 here.
        CHECK((impulse[0].head<3>() - pressed * Vec3(1, -0.5, 0)).norm() < 1e-13);
        const Vec3 u = problem.velocity(0, impulse);
        CHECK(u[0] == Approx(0.5 * u[1]).epsilon(1e-12));
    }
}

TEST_CASE(
    "three times as many contacts as freedoms have one velocity under the associated law, wherever the solve "
    "starts",
    "[unit][lab]") {
    int apart = 0;  // problems whose impulses are not unique
    for (unsigned seed = 0; seed < 5; ++seed) {
        INFO("seed " << seed);
        const DenseProblem problem(24, 24, 0.5, seed);  // 72 rows
        BlockMemory memory;
        memory.prepare(problem.view(), problem.all);
        const SolveLimits limits{1e-12, 100000, false, 1};
        CHECK(solve_prepared(problem, methods[3].solve, limits, memory).converged);
        const std::vector<Vec4> cold = memory.impulse;
        std::mt19937 random(seed);
        std::normal_distribution<Real> noise;
        for (Vec4& impulse : memory.impulse)
            impulse += Vec4(std::abs(noise(random)), 0.2 * noise(random), 0.2 * noise(random), 0);
        CHECK(solve_prepared(problem, methods[3].solve, limits, memory).converged);
        Real impulses = 0, velocities = 0;
        for (std::size_t i = 0; i < problem.q.size(); ++i) {
            impulses = std::max(impulses, (cold[i] - memory.impulse[i]).norm());
            velocities = std::max(velocities, (problem.velocity(i, cold) - problem.velocity(i, memory.impulse)).norm());
        }
        apart += impulses > 1e-3;
        CHECK(velocities < 1e-8);
    }
    CHECK(apart == 4);  // those of seed 2 are unique
}

TEST_CASE("the associated law is solved for no contact and for one, and numbers that are none are reported",
          "[unit][lab]") {
    for (const NamedMethod& method : methods) {
        INFO(method.name);
        std::vector<Vec4> impulse;
        CHECK(solve_dense(DenseProblem(0, 0, 0.3, 1), method.solve, {1e-9, 100, false, 1}, impulse).converged);
        CHECK(solve_dense(DenseProblem(1, 6, 0.3, 1), method.solve, {1e-9, 1000, false, 1}, impulse).converged);
        for (const bool fixed : {false, true})
            for (int place = 0; place < 3; ++place) {
                INFO("fixed " << fixed << " place " << place);
                DenseProblem problem(4, 20, 0.4, 2);
                problem.q[2][place] = std::numeric_limits<Real>::quiet_NaN();
                const SolveResult result = solve_dense(problem, method.solve, {1e-9, 300, fixed, 1}, impulse);
                CHECK_FALSE(result.converged);
                CHECK_FALSE(std::isfinite(result.error));
                CHECK(result.iterations <= 300);
            }
        for (unsigned seed = 0; seed < 30; ++seed)
            for (const Index limit : {1, 5, 47}) {
                INFO("seed " << seed << " limit " << limit);
                const DenseProblem problem(8, seed % 2 == 0 ? 14 : 40, 0.2 + 0.05 * seed, seed);
                BlockMemory memory;
                memory.prepare(problem.view(), problem.all);
                const Real zero = lab::AssociatedOperator(memory, problem.view(), problem.all).error();
                CHECK(solve_prepared(problem, method.solve, {1e-8, limit, true, 1}, memory).error <= zero);
            }
    }
}

TEST_CASE("a solution under the associated law has the errors of that law", "[unit][lab]") {
    ContactProblem problem;
    problem.row_offset = {0, 2, 4};
    problem.column = {0, 1, 0, 1};
    const Mat3 own = Vec3(2, 1.5, 1).asDiagonal(), coupling = 0.4 * Mat3::Identity();
    problem.block = {own, coupling, coupling, own};
    problem.q = {Vec3(-1, 0.8, 0.1), Vec3(-0.5, -0.2, 0.9)};
    problem.mu = {0.3, 0.3};
    const ProblemSolution solution = lab::solve_associated(problem, sweeps, {.tolerance = 1e-10});
    CHECK(solution.converged);
    CHECK(std::abs(solution.energy_gap) < 1e-9);                       // r . u
    CHECK(problem_error(problem, solution.reaction).relative > 1e-3);  // both contacts slide and violate Coulomb's law
}

}  // namespace skerry::test::associated_test
