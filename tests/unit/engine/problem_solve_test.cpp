// Solution of problems from files.
#include <catch2/catch.hpp>
#include <cmath>

#include "problem_samples.h"
#include "skerry/error.h"

namespace skerry::test::problem_solve_test {

namespace fs = std::filesystem;

namespace {

/// Three uncoupled contacts: one sticks, one opens, one slides.
ContactProblem three_apart() {
    ContactProblem problem;
    problem.row_offset = {0, 1, 2, 3};
    problem.column = {0, 1, 2};
    problem.block.assign(3, 2 * Mat3::Identity());
    problem.q = {{-1, 0, 0}, {1, 0, 0}, {-2, 8, 0}};
    problem.mu = {0.5, 0.5, 0.5};
    return problem;
}

}  // namespace

TEST_CASE("a problem of two contacts is solved with both methods and laws", "[unit][problem]") {
    const ContactProblem problem = read_back(local_file());
    for (const SolverMethod method : {SolverMethod::pgs, SolverMethod::pcg_pgs})
        for (const Friction friction : {Friction::cone, Friction::pyramid}) {
            const ProblemSolution solution =
                solve_problem(problem, {.method = method, .friction = friction, .tolerance = 1e-10});
            CHECK(solution.converged);
            CHECK(solution.error <= 1e-10);
            CHECK(solution.regions == 1);
            CHECK(solution.seconds > 0);
            if (friction == Friction::cone) CHECK(independent_error(problem, solution.reaction) <= 1.01e-10);
        }
}

TEST_CASE("contacts without a common block are regions of their own", "[unit][problem]") {
    ContactProblem problem = three_apart();
    const ProblemSolution solution = solve_problem(problem, {});
    CHECK(solution.regions == 3);
    CHECK(solution.largest_region == 1);
    CHECK(solution.unconverged == 0);
    CHECK(solution.converged);
    CHECK((solution.reaction[0] - Vec3(0.5, 0, 0)).norm() < 1e-15);
    CHECK(solution.reaction[1] == Vec3::Zero());
    CHECK((solution.reaction[2] - Vec3(1, -0.5, 0)).norm() < 1e-14);
    problem.mu.pop_back();
    CHECK_THROWS_AS(solve_problem(problem, {}), SceneError);
}

TEST_CASE("an empty problem is solved", "[unit][problem]") {
    ContactProblem problem;
    problem.row_offset = {0};
    const ProblemSolution solution = solve_problem(problem, {});
    CHECK(solution.converged);
    CHECK(solution.regions == 0);
}

TEST_CASE("a problem that cannot be solved within the limit says so", "[unit][problem]") {
    const ProblemSolution solution = solve_problem(read_back(local_file()), {.tolerance = 0, .max_iterations = 3});
    CHECK_FALSE(solution.converged);
    CHECK(solution.iterations == 3);
    CHECK(solution.unconverged == 1);
    CHECK(solution.largest_region == 2);
}

TEST_CASE("the error is that of FCLIB", "[unit][problem]") {
    const ContactProblem problem = read_back(local_file());
    const std::vector<Vec3> guess{{0.3, 0.1, -0.2}, {0.9, -0.3, 0.1}};
    const ProblemError error = problem_error(problem, guess);
    CHECK(error.relative == Approx(independent_error(problem, guess)).epsilon(1e-13));
    CHECK(error.absolute / error.over_q == Approx(std::sqrt(1 + 0.25 + 0.01 + 4 + 0.09 + 0.04)).epsilon(1e-13));
    CHECK_THROWS_AS(problem_error(problem, std::vector<Vec3>(1)), SceneError);
}

TEST_CASE("the energy gap is the work that Coulomb's law does not explain", "[unit][problem]") {
    const ContactProblem problem = three_apart();
    const ProblemSolution solution = solve_problem(problem, {.tolerance = 1e-12});
    CHECK(std::abs(solution.energy_gap) < 1e-12);
    // by hand: u = 2 r + q, gap = r_n u_n + mu r_n |u_t| + r_t . u_t
    CHECK(problem_error(problem, std::vector<Vec3>{{1, 0, 0}, Vec3::Zero(), Vec3::Zero()}).energy_gap ==
          Approx(1).epsilon(1e-15));
    CHECK(problem_error(problem, std::vector<Vec3>{Vec3::Zero(), Vec3::Zero(), {1, 0, 0}}).energy_gap ==
          Approx(0.5 * 8).epsilon(1e-15));
    CHECK(problem_error(problem, std::vector<Vec3>{Vec3::Zero(), Vec3::Zero(), {1, -0.5, 0}}).energy_gap ==
          Approx(0).margin(1e-14));
    // The gap of the pyramid is measured for the pyramid: oblique sliding with both tangents at their bounds.
    ContactProblem askew = problem;
    askew.q[2] = {-2, 8, 8};
    const ProblemSolution pyramid = solve_problem(askew, {.friction = Friction::pyramid, .tolerance = 1e-12});
    CHECK((pyramid.reaction[2] - Vec3(1, -0.5, -0.5)).norm() < 1e-14);
    CHECK(std::abs(pyramid.energy_gap) < 1e-12);
}

TEST_CASE("problems of the FCLIB collection load, and all but one are solved to 1e-6", "[unit][problem][slow]") {
    const std::optional<fs::path> folder = problems_of_others();
    if (!folder) return;
    int count = 0;
    for (const fs::directory_entry& file : fs::directory_iterator(*folder)) {
        if (file.path().extension() != ".hdf5") continue;
        ++count;
        const ContactProblem problem = read_problem(file.path());
        // Gauss-Seidel stagnates at 8e-5 there; so-bogus, also Gauss-Seidel, does not reach 1e-6 either.
        const bool hard = problem.name.starts_with("OneObject");
        const Real tolerance = hard ? 1e-3 : 1e-6;
        const ProblemSolution solution = solve_problem(problem, {.tolerance = tolerance});
        INFO(problem.name << " " << solution.error);
        CHECK(solution.converged);
        CHECK(independent_error(problem, solution.reaction) <= tolerance * (1 + 1e-6));
    }
    CHECK(count >= 18);
}

}  // namespace skerry::test::problem_solve_test
