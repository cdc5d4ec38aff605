// What holds for every method: the same solution, its limits, and what is no ordinary problem.
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
/// Newton steps are those of Coulomb's cone; for other laws only the sweeps between them are left.
bool is_for(SolverMethod method, Friction friction) {
    return !needs_frictionless(method) && !(method == SolverMethod::newton && friction != Friction::cone);
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
    memory.prepare(system, problem.all, friction);
    BlockOperator op(memory, 0, problem.contacts(), friction, 0);
    const SolveResult result = run_method(method, op, limits);
    impulse = memory.impulse;
    return result;
}

}  // namespace

TEST_CASE("all methods come to the same velocities on sheets, for every friction law", "[unit][solver]") {
    for (const Friction friction : {Friction::cone, Friction::pyramid, Friction::cone_convex})
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

TEST_CASE("proportioning comes to the solution of Gauss-Seidel on dense blocks without friction", "[unit][solver]") {
    for (const int freedoms : {60, 24})  // with 24 the matrix is singular: impulses are not unique, velocities are
        for (unsigned seed = 0; seed < 10; ++seed) {
            INFO(freedoms << " freedoms, seed " << seed);
            const DenseProblem problem(12, freedoms, 0, seed);
            std::vector<Vec4> swept, proportioned;
            CHECK(solve_dense(problem, SolverMethod::pgs, Friction::cone, {1e-13, 200000, false, 1}, swept).converged);
            const SolveResult result =
                solve_dense(problem, SolverMethod::mprgp, Friction::cone, {1e-13, 2000, false, 1}, proportioned);
            CHECK(result.converged);
            CHECK(result.iterations < 200);  // it is finite: a few faces of at most 12 unknowns
            for (std::size_t i = 0; i < problem.q.size(); ++i)
                CHECK((problem.velocity(i, swept) - problem.velocity(i, proportioned)).norm() <
                      1e-10 * (1 + problem.q[i].norm()));
        }
}

TEST_CASE("gradients and sweeps agree on the associated law, and it is not Coulomb's", "[unit][solver]") {
    for (unsigned seed = 0; seed < 10; ++seed) {
        INFO("seed " << seed);
        const DenseProblem problem(8, 40, 0.6, seed);
        std::vector<Vec4> swept, stepped, coulomb;
        CHECK(
            solve_dense(problem, SolverMethod::pgs, Friction::cone_convex, {1e-12, 50000, false, 1}, swept).converged);
        CHECK(solve_dense(problem, SolverMethod::apgd, Friction::cone_convex, {1e-12, 50000, false, 1}, stepped)
                  .converged);
        CHECK(solve_dense(problem, SolverMethod::pgs, Friction::cone, {1e-12, 50000, false, 1}, coulomb).converged);
        Real difference = 0;
        for (std::size_t i = 0; i < problem.q.size(); ++i) {
            const Vec3 u = problem.velocity(i, swept), r = swept[i].head<3>();
            const Real size = 1 + problem.q[i].norm();
            CHECK((u - problem.velocity(i, stepped)).norm() < 1e-8 * size);
            // r in the cone, u in the dual cone, at right angles: from W and q alone
            CHECK(std::hypot(r[1], r[2]) <= 0.6 * r[0] * (1 + 1e-12));
            CHECK(u[0] - 0.6 * std::hypot(u[1], u[2]) > -1e-9 * size);
            CHECK(std::abs(u.dot(r)) < 1e-9 * size);
            difference = std::max(difference, (u - problem.velocity(i, coulomb)).norm() / size);
        }
        CHECK(difference > 1e-3);
    }
}

TEST_CASE("what slides apart slowly still presses under the associated law", "[unit][solver]") {
    ContactScene scene;
    const Index node = scene.add_node(2, Vec3(1, 0, 0.1));
    scene.touch_floor(node, 0.5);
    CHECK(scene.solve(strict(SolverMethod::pgs)).impulse[0] == Vec3::Zero());
    // lifts off at mu times its speed: z = -m v, (z_n + mu |z_t|) / (1 + mu^2)
    const Real pressed = 2 * (-0.1 + 0.5) / 1.25;
    for (const bool fixed : {false, true}) {
        SolverSettings settings = strict(SolverMethod::pgs, Friction::cone_convex);
        settings.fixed_iterations = fixed;
        settings.max_iterations = 3;
        const SolvedScene solved = scene.solve(settings);
        CHECK((solved.impulse[0] - pressed * Vec3(-0.5, 0, 1)).norm() < 1e-14);
        CHECK(solved.velocity[0].z() == Approx(0.5 * solved.velocity[0].x()).epsilon(1e-12));
    }
}

TEST_CASE(
    "no contacts, one contact, contacts that nothing can move, and contacts that separate are no trouble to any method",
    "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
        INFO(name);
        const Real mu = needs_frictionless(method) ? 0 : 0.3;
        std::vector<Vec4> impulse;
        CHECK(solve_dense(DenseProblem(0, 0, mu, 1), method, Friction::cone, {1e-9, 100, false, 1}, impulse).converged);
        if (!stagnates(method))
            CHECK(solve_dense(DenseProblem(1, 6, mu, 1), method, Friction::cone, {1e-9, 1000, false, 1}, impulse)
                      .converged);

        // one global region: a node on a plate that does not move, a pinned node on the plate, and one that leaves it
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
        CHECK((solved.impulse[0] - Vec3(mu > 0 ? -0.6 : 0, 0, 2)).norm() < 1e-8);

        // the same with fixed iterations, which no certificate saves from being done
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
        for (const Friction friction : {Friction::cone, Friction::pyramid, Friction::cone_convex})
            for (const bool fixed : {false, true})
                for (int place = 0; place < 3; ++place) {
                    // has no tangents
                    if (friction == Friction::pyramid && place > 0 && needs_frictionless(method)) continue;
                    INFO(name << " " << name_of(friction) << " fixed " << fixed << " place " << place);
                    DenseProblem problem(4, 20, needs_frictionless(method) ? 0 : 0.4, 2);
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
        for (const Friction friction : {Friction::cone, Friction::pyramid, Friction::cone_convex}) {
            if (!is_for(method, friction) && !needs_frictionless(method)) continue;
            ContactScene scene;
            add_sheets(scene, 10, needs_frictionless(method) ? 0 : 0.5, 3);
            SolverSettings settings = strict(method, friction);
            settings.tolerance = 1e-300;  // never met by sweeps; Newton's steps come to what rounding leaves
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
                if (method == SolverMethod::newton) continue;  // ends when there is nothing left to step to
                settings.fixed_iterations = true;
                const SolvedScene fixed = scene.solve(settings);
                CHECK(fixed.regions.iterations[0] == limit);
                CHECK(std::isfinite(fixed.regions.error[0]));
            }
        }
}

// Found by random scenes: projected conjugate gradients went uphill for as long as they were told to, to errors of 1e6.
TEST_CASE("with a fixed count none is worse than a start from zero, nor conjugate gradients than any start",
          "[unit][solver]") {
    constexpr int contacts = 8;
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid, Friction::cone_convex})
            for (unsigned seed = 0; seed < 30; ++seed)
                for (const Index limit : {1, 5, 47}) {
                    INFO(name << " " << name_of(friction) << " seed " << seed << " limit " << limit);
                    const Real mu = needs_frictionless(method) ? 0 : 0.2 + 0.05 * seed;
                    const DenseProblem problem(contacts, seed % 2 == 0 ? 14 : 40, mu, seed);
                    const BlockSystem system = problem.view();
                    BlockMemory memory;
                    memory.prepare(system, problem.all, friction);
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
            const DenseProblem problem(8, 40, needs_frictionless(method) ? 0 : 0.5, 4);
            const BlockSystem system = problem.view();
            BlockMemory memory;
            memory.prepare(system, problem.all);
            BlockOperator op(memory, 0, 8, Friction::cone, 0);
            const SolveResult result = run_method(method, op, {1e-8, limit, false, 1});
            CHECK(op.error() == result.error);
            CHECK(result.converged == (result.error <= 1e-8));
        }
}

TEST_CASE("nonlinear conjugate gradients and accelerated gradients need far fewer iterations than sweeps in a stack",
          "[unit][solver]") {
    for (const Real mu : {0.0, 0.5}) {
        ContactScene scene;
        Index below = scene.add_node(1, Vec3(0.3, 0, -1));
        scene.touch_floor(below, mu);
        for (int k = 1; k < 20; ++k) {
            const Index above = scene.add_node(1, Vec3(0.3, 0, -1));
            scene.touch_node(above, below, Vec3(0.05 * (k % 3 - 1), 0.02, 1), mu);
            below = above;
        }
        SolverSettings settings = strict(SolverMethod::pgs);
        settings.tolerance = 1e-8;
        const Index sweeps = scene.solve(settings).regions.iterations[0];
        for (const SolverMethod method : {SolverMethod::nncg, SolverMethod::apgd}) {
            settings.method = method;
            const SolvedScene solved = scene.solve(settings);
            INFO(name_of(method) << ", mu " << mu << ", against " << sweeps);
            CHECK(solved.regions.status[0] == RegionStatus::converged);
            CHECK(3 * solved.regions.iterations[0] < sweeps);
        }
    }
}

}  // namespace skerry::test::methods_test
