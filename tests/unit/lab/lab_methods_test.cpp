// Methods of the lab: agreement with the sweeps, iteration limits, and degenerate problems.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "profiling/lab/region_solver.h"
#include "profiling/lab/solve_problem.h"
#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/pgs.h"
#include "tests/support/contact_scene.h"
#include "tests/unit/solver/dense_problem.h"

namespace skerry::test::lab_methods_test {

namespace {

/// A method and a friction law that it supports.
struct Case {
    lab::Method method;
    Friction friction;
    Real mu;  // 0 if the method is for contacts without friction
};

std::vector<Case> cases(Real mu) {
    std::vector<Case> all;
    for (const auto& [method, name] : EnumNames<lab::Method>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid})
            all.push_back({method, friction, lab::needs_frictionless(method) ? 0 : mu});
    return all;
}
std::string text(const Case& one) {
    return std::string(name_of(one.method)) + " " + std::string(name_of(one.friction));
}

SolverSettings strict(Friction friction = Friction::cone) {
    SolverSettings settings;
    settings.method = SolverMethod::pgs;
    settings.friction = friction;
    settings.tolerance = 1e-10;
    settings.max_iterations = 50000;
    return settings;
}

/// Solves a scene like ContactScene::solve, with a method of the lab.
SolvedScene solve_by(lab::Method method, const ContactScene& scene, const SolverSettings& settings,
                     ContactRegions mode = ContactRegions::separate) {
    SolvedScene result;
    const auto executor = make_executor(Backend::serial, 1);
    SeparationMemory memory;
    std::vector<Index> region(scene.stencil.size());
    separate_regions(*executor, scene.stencil, scene.inverse_mass, NodeGroups{}, mode, memory, result.regions, region);
    result.impulse = scene.impulse;
    result.velocity = scene.velocity;
    result.push_out.assign(scene.velocity.size(), Vec3::Zero());
    lab::RegionSolver solver;
    solver.solve(*executor, scene.inputs(), settings, method, scene.h, result.regions,
                 {result.impulse, result.velocity, result.push_out});
    return result;
}

void check_same_velocities(const SolvedScene& a, const SolvedScene& b, Real tolerance) {
    Real worst = 0;
    for (std::size_t n = 0; n < a.velocity.size(); ++n) worst = std::max(worst, (a.velocity[n] - b.velocity[n]).norm());
    CHECK(worst < tolerance);
}

SolveResult solve_dense(const DenseProblem& problem, lab::Method method, Friction friction, const SolveLimits& limits,
                        std::vector<Vec4>& impulse) {
    BlockMemory memory;
    memory.prepare(problem.view(), problem.all);
    BlockOperator op(memory, 0, problem.contacts(), friction, 0);
    const SolveResult result = lab::run(method, op, limits);
    impulse = memory.impulse;
    return result;
}

}  // namespace

TEST_CASE("methods of the lab come to the velocities of sweeps on sheets, with cone and pyramid", "[unit][lab]") {
    for (const Case& one : cases(0.4))
        for (unsigned seed = 0; seed < 4; ++seed) {
            if (lab::needs_frictionless(one.method)) continue;
            INFO(text(one) << " seed " << seed);
            ContactScene scene;
            add_sheets(scene, 6, one.mu, seed);
            const SolvedScene swept = scene.solve(strict(one.friction));
            const SolvedScene solved = solve_by(one.method, scene, strict(one.friction));
            CHECK(solved.regions.status[0] == RegionStatus::converged);
            check_same_velocities(swept, solved, 1e-6);
        }
}

TEST_CASE("without friction methods of the lab come to the velocities of sweeps", "[unit][lab]") {
    for (unsigned seed = 0; seed < 4; ++seed) {
        ContactScene scene;
        add_sheets(scene, 8, 0, seed);
        SolverSettings settings = strict();
        settings.tolerance = 1e-13;
        const SolvedScene swept = scene.solve(settings);
        for (const auto& [method, name] : EnumNames<lab::Method>::table) {
            INFO(name << " seed " << seed);
            const SolvedScene solved = solve_by(method, scene, settings);
            CHECK(solved.regions.status[0] == RegionStatus::converged);
            check_same_velocities(swept, solved, 1e-10);
        }
    }
}

TEST_CASE("methods of the lab solve large regions in the order of colours", "[unit][lab]") {
    ContactScene scene;
    add_sheets(scene, 12, 0.3, 1);
    SolverSettings settings = strict();
    const SolvedScene swept = scene.solve(settings);
    settings.parallel_region_contacts = 100;  // less than the 200 contacts
    for (const lab::Method method : {lab::Method::nncg, lab::Method::apgd}) {
        INFO(name_of(method));
        const SolvedScene solved = solve_by(method, scene, settings);
        CHECK(solved.regions.status[0] == RegionStatus::converged);
        check_same_velocities(swept, solved, 1e-6);
    }
}

TEST_CASE("methods of the lab solve dense random blocks with cone and pyramid", "[unit][lab]") {
    for (const Case& one : cases(0.4))
        for (unsigned seed = 0; seed < 10; ++seed) {
            const DenseProblem problem(6, 30, one.mu, seed);
            std::vector<Vec4> impulse;
            const SolveResult result = solve_dense(problem, one.method, one.friction, {1e-8, 20000, false, 1}, impulse);
            INFO(text(one) << " seed " << seed << " error " << result.error);
            CHECK(result.converged);
            // This check uses W and r alone.
            for (std::size_t i = 0; i < 6; ++i) {
                const Vec3 u = problem.velocity(i, impulse), r = impulse[i].head<3>();
                const Real size = 1 + u.norm();
                const Real load =
                    one.friction == Friction::cone ? std::hypot(r[1], r[2]) : std::max(std::abs(r[1]), std::abs(r[2]));
                CHECK(r[0] >= 0);
                CHECK(load <= one.mu * r[0] * (1 + 1e-12));
                CHECK(u[0] > -1e-6 * size);
                CHECK(std::abs(r[0] * u[0]) < 1e-5 * size);
                CHECK(r[1] * u[1] + r[2] * u[2] < 1e-5 * size);
            }
        }
}

TEST_CASE("proportioning comes to the solution of Gauss-Seidel on dense blocks without friction", "[unit][lab]") {
    for (const int freedoms : {60, 24})  // with 24 the matrix is singular: impulses are not unique, velocities are
        for (unsigned seed = 0; seed < 10; ++seed) {
            INFO(freedoms << " freedoms, seed " << seed);
            const DenseProblem problem(12, freedoms, 0, seed);
            BlockMemory memory;
            memory.prepare(problem.view(), problem.all);
            BlockOperator op(memory, 0, 12, Friction::cone, 0);
            CHECK(solve_pgs(op, {1e-13, 200000, false, 1}).converged);
            std::vector<Vec4> proportioned;
            const SolveResult result =
                solve_dense(problem, lab::Method::mprgp, Friction::cone, {1e-13, 2000, false, 1}, proportioned);
            CHECK(result.converged);
            CHECK(result.iterations < 200);  // the method is finite: a few faces of at most 12 unknowns
            for (std::size_t i = 0; i < problem.q.size(); ++i)
                CHECK((problem.velocity(i, memory.impulse) - problem.velocity(i, proportioned)).norm() <
                      1e-10 * (1 + problem.q[i].norm()));
        }
}

TEST_CASE(
    "no contacts, one contact, contacts that nothing can move, and contacts that separate are no trouble to the lab",
    "[unit][lab]") {
    for (const auto& [method, name] : EnumNames<lab::Method>::table) {
        INFO(name);
        const Real mu = lab::needs_frictionless(method) ? 0 : 0.3;
        std::vector<Vec4> impulse;
        CHECK(solve_dense(DenseProblem(0, 0, mu, 1), method, Friction::cone, {1e-9, 100, false, 1}, impulse).converged);
        CHECK(
            solve_dense(DenseProblem(1, 6, mu, 1), method, Friction::cone, {1e-9, 1000, false, 1}, impulse).converged);

        // One global region: a node on a fixed plate, a pinned node on the plate, and one that leaves it.
        ContactScene scene;
        const Index plate = scene.add_node(0, Vec3(0, 0, 0));
        scene.touch_node(scene.add_node(2, Vec3(0.5, 0, -1)), plate, Vec3(0, 0, 1), mu);
        scene.touch_node(scene.add_node(0, Vec3(0, 0, -1)), plate, Vec3(0, 0, 1), mu);
        scene.touch_node(scene.add_node(3, Vec3(1, 0, 1)), plate, Vec3(0, 0, 1), mu);
        const SolvedScene solved = solve_by(method, scene, strict(), ContactRegions::global);
        REQUIRE(solved.regions.size() == 1);
        CHECK(solved.impulse[1] == Vec3::Zero());
        CHECK(solved.velocity[2] == Vec3(0, 0, -1));
        CHECK(solved.velocity[3] == Vec3(1, 0, 1));
        CHECK(solved.regions.status[0] == RegionStatus::converged);
        CHECK((solved.impulse[0] - Vec3(mu > 0 ? -0.6 : 0, 0, 2)).norm() < 1e-8);

        // With a fixed count the iterations are done even if a certificate would save them.
        SolverSettings fixed = strict();
        fixed.fixed_iterations = true;
        fixed.max_iterations = 7;
        ContactScene apart;
        const Index lower = apart.add_node(1, Vec3(0, 0, -1)), upper = apart.add_node(1, Vec3(0, 0.5, 1));
        apart.touch_node(upper, lower, Vec3(0, 0, 1), mu);
        apart.touch_floor(upper, mu);
        const SolvedScene left = solve_by(method, apart, fixed, ContactRegions::global);
        CHECK((left.velocity[static_cast<std::size_t>(upper)] - Vec3(0, 0.5, 1)).norm() < 1e-15);
        CHECK(left.impulse[0] == Vec3::Zero());
        CHECK(left.regions.iterations[0] == 7);
    }
}

TEST_CASE("methods of the lab say so when a number is not one", "[unit][lab]") {
    for (const Case& one : cases(0.4))
        for (const bool fixed : {false, true})
            for (int place = 0; place < 3; ++place) {
                // without friction there are no tangents
                if (one.friction == Friction::pyramid && place > 0 && lab::needs_frictionless(one.method)) continue;
                INFO(text(one) << " fixed " << fixed << " place " << place);
                DenseProblem problem(4, 20, one.mu, 2);
                problem.q[2][place] = std::numeric_limits<Real>::quiet_NaN();
                std::vector<Vec4> impulse;
                const SolveResult result =
                    solve_dense(problem, one.method, one.friction, {1e-9, 300, fixed, 1}, impulse);
                CHECK_FALSE(result.converged);
                CHECK_FALSE(std::isfinite(result.error));
                CHECK(result.iterations <= 300);
            }
}

TEST_CASE("no method of the lab takes more iterations than allowed, and none is worse than its start", "[unit][lab]") {
    for (const Case& one : cases(0.5)) {
        ContactScene scene;
        add_sheets(scene, 10, one.mu, 3);
        SolverSettings settings = strict(one.friction);
        settings.tolerance = 1e-300;  // never met
        for (const Index limit : {1, 2, 5, 40}) {
            INFO(text(one) << " " << limit);
            settings.max_iterations = limit;
            settings.fixed_iterations = false;
            const SolvedScene solved = solve_by(one.method, scene, settings);
            CHECK(solved.regions.iterations[0] == limit);
            CHECK(solved.regions.status[0] == RegionStatus::iteration_limit);
            CHECK(solved.regions.error[0] <= 1.2);  // the start from zero has about 1
            settings.fixed_iterations = true;
            const SolvedScene fixed = solve_by(one.method, scene, settings);
            CHECK(fixed.regions.iterations[0] == limit);
            CHECK(std::isfinite(fixed.regions.error[0]));
        }
    }
}

TEST_CASE("with a fixed count no method of the lab is worse than a start from zero", "[unit][lab]") {
    for (const Case& one : cases(1))
        for (unsigned seed = 0; seed < 30; ++seed)
            for (const Index limit : {1, 5, 47}) {
                INFO(text(one) << " seed " << seed << " limit " << limit);
                const DenseProblem problem(8, seed % 2 == 0 ? 14 : 40, one.mu * (0.2 + 0.05 * seed), seed);
                BlockMemory memory;
                memory.prepare(problem.view(), problem.all);
                BlockOperator op(memory, 0, 8, one.friction, 0);
                const Real zero = op.error();
                CHECK(lab::run(one.method, op, {1e-8, limit, true, 1}).error <= zero);
            }
}

TEST_CASE("the error that a method of the lab reports is that of the impulses it leaves", "[unit][lab]") {
    for (const auto& [method, name] : EnumNames<lab::Method>::table)
        for (const Index limit : {3, 30, 100000}) {
            INFO(name << " " << limit);
            const DenseProblem problem(8, 40, lab::needs_frictionless(method) ? 0 : 0.5, 4);
            BlockMemory memory;
            memory.prepare(problem.view(), problem.all);
            BlockOperator op(memory, 0, 8, Friction::cone, 0);
            const SolveResult result = lab::run(method, op, {1e-8, limit, false, 1});
            CHECK(op.error() == result.error);
            CHECK(result.converged == (result.error <= 1e-8));
        }
}

TEST_CASE("nonlinear conjugate gradients and accelerated gradients need far fewer iterations than sweeps in a stack",
          "[unit][lab]") {
    for (const Real mu : {0.0, 0.5}) {
        ContactScene scene;
        Index below = scene.add_node(1, Vec3(0.3, 0, -1));
        scene.touch_floor(below, mu);
        for (int k = 1; k < 20; ++k) {
            const Index above = scene.add_node(1, Vec3(0.3, 0, -1));
            scene.touch_node(above, below, Vec3(0.05 * (k % 3 - 1), 0.02, 1), mu);
            below = above;
        }
        SolverSettings settings = strict();
        settings.tolerance = 1e-8;
        const Index sweeps = scene.solve(settings).regions.iterations[0];
        for (const lab::Method method : {lab::Method::nncg, lab::Method::apgd}) {
            const SolvedScene solved = solve_by(method, scene, settings);
            INFO(name_of(method) << ", mu " << mu << ", against " << sweeps);
            CHECK(solved.regions.status[0] == RegionStatus::converged);
            CHECK(3 * solved.regions.iterations[0] < sweeps);
        }
    }
}

TEST_CASE("problems are solved by methods of the lab, and one that leaves friction out is refused where there is some",
          "[unit][lab]") {
    ContactProblem problem;
    problem.name = "pair";
    problem.row_offset = {0, 2, 4};
    problem.column = {0, 1, 0, 1};
    const Mat3 own = Vec3(2, 1.5, 1).asDiagonal(), coupling = 0.4 * Mat3::Identity();
    problem.block = {own, coupling, coupling, own};
    problem.q = {Vec3(-1, 0.8, 0.1), Vec3(-0.5, -0.2, 0.9)};
    problem.mu = {0.3, 0.3};
    for (const lab::Method method : {lab::Method::nncg, lab::Method::apgd}) {
        const ProblemSolution solution = lab::solve_problem(problem, method, {.tolerance = 1e-12});
        CHECK(solution.converged);
        CHECK(problem_error(problem, solution.reaction).relative <= 1e-12);
    }
    CHECK_THROWS_WITH(lab::solve_problem(problem, lab::Method::mprgp, {}), Catch::Matchers::Contains("mprgp"));
    problem.mu = {0, 0};
    CHECK(lab::solve_problem(problem, lab::Method::mprgp, {.tolerance = 1e-12}).converged);
}

}  // namespace skerry::test::lab_methods_test
