// Properties of every method: equal solutions, iteration limits, and degenerate problems.
#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "systems/solver/methods/run_method.h"
#include "tests/support/contact_scene.h"
#include "tests/unit/solver/dense_problem.h"

namespace skerry::test::methods_test {

namespace {

bool stagnates(SolverMethod method) {
    return method == SolverMethod::pcg_fr || method == SolverMethod::pcg_pr;
}
/// Newton steps are for Coulomb's cone; for other laws only the sweeps between them remain.
bool is_for(SolverMethod method, Friction friction) {
    return method != SolverMethod::newton || friction == Friction::cone;
}

SolverSettings strict(SolverMethod method, Friction friction = Friction::cone) {
    SolverSettings settings;
    settings.method = method;
    settings.friction = friction;
    settings.tolerance = 1e-10;
    settings.max_iterations = 50000;
    settings.frictionless_rows = false;
    settings.small_regions_in_lanes = false;
    return settings;
}

void check_same_velocities(const SolvedScene& a, const SolvedScene& b, Real tolerance) {
    Real worst = 0;
    for (std::size_t n = 0; n < a.velocity.size(); ++n) worst = std::max(worst, (a.velocity[n] - b.velocity[n]).norm());
    CHECK(worst < tolerance);
}

SolveResult solve_dense(const DenseProblem& problem, SolverMethod method, Friction friction, const SolveLimits& limits,
                        std::vector<Vec4>& impulse) {
    const BlockSystem system = problem.view();
    BlockMemory memory;
    memory.prepare(system, problem.all);
    BlockOperator op(memory, 0, problem.contacts(), friction, 0);
    const SolveResult result = run_method(method, op, limits);
    impulse = memory.impulse;
    return result;
}

}  // namespace

TEST_CASE("all methods come to the same velocities on sheets, for every friction law", "[unit][solver]") {
    for (const Friction friction : {Friction::cone, Friction::pyramid})
        for (unsigned seed = 0; seed < 4; ++seed) {
            ContactScene scene;
            add_sheets(scene, 6, 0.4, seed);
            const SolvedScene swept = scene.solve(strict(SolverMethod::pgs, friction));
            REQUIRE(swept.regions.status[0] == RegionStatus::converged);
            for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
                if (stagnates(method) || !is_for(method, friction)) continue;
                INFO(name << " " << name_of(friction) << " seed " << seed);
                const SolvedScene solved = scene.solve(strict(method, friction));
                CHECK(solved.regions.status[0] == RegionStatus::converged);
                check_same_velocities(swept, solved, 1e-6);
            }
        }
}

TEST_CASE("without friction all methods come to the same velocities", "[unit][solver]") {
    for (unsigned seed = 0; seed < 4; ++seed) {
        ContactScene scene;
        add_sheets(scene, 8, 0, seed);
        SolverSettings settings = strict(SolverMethod::pgs);
        settings.tolerance = 1e-13;
        const SolvedScene swept = scene.solve(settings);
        REQUIRE(swept.regions.status[0] == RegionStatus::converged);
        for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
            if (stagnates(method)) continue;
            INFO(name << " seed " << seed);
            settings.method = method;
            const SolvedScene solved = scene.solve(settings);
            CHECK(solved.regions.status[0] == RegionStatus::converged);
            check_same_velocities(swept, solved, 1e-10);
        }
    }
}

TEST_CASE(
    "no contacts, one contact, contacts that nothing can move, and contacts that separate are no trouble to any method",
    "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
        INFO(name);
        constexpr Real mu = 0.3;
        std::vector<Vec4> impulse;
        CHECK(solve_dense(DenseProblem(0, 0, mu, 1), method, Friction::cone, {1e-9, 100, false, 1}, impulse).converged);
        if (!stagnates(method))
            CHECK(solve_dense(DenseProblem(1, 6, mu, 1), method, Friction::cone, {1e-9, 1000, false, 1}, impulse)
                      .converged);

        // One global region: a node on a fixed plate, a pinned node on the plate, and one that leaves it.
        ContactScene scene;
        const Index plate = scene.add_node(0, Vec3(0, 0, 0));
        scene.touch_node(scene.add_node(2, Vec3(0.5, 0, -1)), plate, Vec3(0, 0, 1), mu);
        scene.touch_node(scene.add_node(0, Vec3(0, 0, -1)), plate, Vec3(0, 0, 1), mu);
        scene.touch_node(scene.add_node(3, Vec3(1, 0, 1)), plate, Vec3(0, 0, 1), mu);
        const SolvedScene solved = scene.solve(strict(method), ContactRegions::global);
        REQUIRE(solved.regions.size() == 1);
        CHECK(solved.impulse[1] == Vec3::Zero());
        CHECK(solved.velocity[2] == Vec3(0, 0, -1));
        if (stagnates(method)) continue;
        CHECK(solved.velocity[3] == Vec3(1, 0, 1));
        CHECK(solved.regions.status[0] == RegionStatus::converged);
        CHECK((solved.impulse[0] - Vec3(-0.6, 0, 2)).norm() < 1e-8);

        // With a fixed count the iterations are done even if a certificate would save them.
        SolverSettings fixed = strict(method);
        fixed.fixed_iterations = true;
        fixed.max_iterations = 7;
        ContactScene apart;
        const Index lower = apart.add_node(1, Vec3(0, 0, -1)), upper = apart.add_node(1, Vec3(0, 0.5, 1));
        apart.touch_node(upper, lower, Vec3(0, 0, 1), mu);
        apart.touch_floor(upper, mu);
        const SolvedScene left = apart.solve(fixed, ContactRegions::global);
        CHECK((left.velocity[static_cast<std::size_t>(upper)] - Vec3(0, 0.5, 1)).norm() < 1e-15);
        CHECK(left.impulse[0] == Vec3::Zero());
        CHECK(left.regions.iterations[0] == 7);
    }
}

TEST_CASE("every method says so when a number is not one", "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid})
            for (const bool fixed : {false, true})
                for (int place = 0; place < 3; ++place) {
                    INFO(name << " " << name_of(friction) << " fixed " << fixed << " place " << place);
                    DenseProblem problem(4, 20, 0.4, 2);
                    problem.q[2][place] = std::numeric_limits<Real>::quiet_NaN();
                    std::vector<Vec4> impulse;
                    const SolveResult result = solve_dense(problem, method, friction, {1e-9, 300, fixed, 1}, impulse);
                    CHECK_FALSE(result.converged);
                    CHECK_FALSE(std::isfinite(result.error));
                    CHECK(result.iterations <= 300);
                }
}

TEST_CASE("no method takes more iterations than allowed, and none is worse than its start", "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid}) {
            if (!is_for(method, friction)) continue;
            ContactScene scene;
            add_sheets(scene, 10, 0.5, 3);
            SolverSettings settings = strict(method, friction);
            settings.tolerance = 1e-300;  // never met by sweeps; Newton steps reach the level of rounding
            for (const Index limit : {1, 2, 5, 40}) {
                INFO(name << " " << name_of(friction) << " " << limit);
                settings.max_iterations = limit;
                settings.fixed_iterations = false;
                const SolvedScene solved = scene.solve(settings);
                const bool exact =
                    method == SolverMethod::newton && solved.regions.status[0] == RegionStatus::converged;
                CHECK((exact || solved.regions.iterations[0] == limit));
                CHECK((exact || solved.regions.status[0] == RegionStatus::iteration_limit));
                CHECK(solved.regions.error[0] <= 1.2);         // the start from zero has about 1
                if (method == SolverMethod::newton) continue;  // ends when no step is left
                settings.fixed_iterations = true;
                const SolvedScene fixed = scene.solve(settings);
                CHECK(fixed.regions.iterations[0] == limit);
                CHECK(std::isfinite(fixed.regions.error[0]));
            }
        }
}

// Without a safeguard, projected conjugate gradients with a fixed count diverge in random scenes, to errors of 1e6.
TEST_CASE("with a fixed count none is worse than a start from zero, nor conjugate gradients than any start",
          "[unit][solver]") {
    constexpr int contacts = 8;
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid})
            for (unsigned seed = 0; seed < 30; ++seed)
                for (const Index limit : {1, 5, 47}) {
                    INFO(name << " " << name_of(friction) << " seed " << seed << " limit " << limit);
                    const Real mu = 0.2 + 0.05 * seed;
                    const DenseProblem problem(contacts, seed % 2 == 0 ? 14 : 40, mu, seed);
                    const BlockSystem system = problem.view();
                    BlockMemory memory;
                    memory.prepare(system, problem.all);
                    BlockOperator op(memory, 0, contacts, friction, 0);
                    const SolveLimits limits{1e-8, limit, true, 1};
                    const Real zero = op.error();
                    CHECK(run_method(method, op, limits).error <= zero);
                    if (!stagnates(method) && method != SolverMethod::pcg_pgs) continue;
                    std::ranges::fill(op.impulse(), Vec4::Zero());
                    op.refresh();
                    run_method(SolverMethod::ags, op, {1e-2, 3000, false, 1});
                    const Real start = op.error();
                    const SolveResult result = run_method(method, op, limits);
                    CHECK(result.error <= start);
                    CHECK(result.error == op.error());
                    CHECK(result.iterations == limit);
                }
}

TEST_CASE("the error that a method reports is that of the impulses it leaves", "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Index limit : {3, 30, 100000}) {
            INFO(name << " " << limit);
            const DenseProblem problem(8, 40, 0.5, 4);
            const BlockSystem system = problem.view();
            BlockMemory memory;
            memory.prepare(system, problem.all);
            BlockOperator op(memory, 0, 8, Friction::cone, 0);
            const SolveResult result = run_method(method, op, {1e-8, limit, false, 1});
            CHECK(op.error() == result.error);
            CHECK(result.converged == (result.error <= 1e-8));
        }
}

}  // namespace skerry::test::methods_test
