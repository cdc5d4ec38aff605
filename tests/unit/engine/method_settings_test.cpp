// Effect of the chosen method, friction law and relaxation on worlds and problems.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "engine/world/state/step_scratch.h"
#include "engine/world/tuning.h"
#include "skerry/problem.h"
#include "skerry/world.h"
#include "tests/support/message_of.h"

namespace skerry::test::method_settings_test {

namespace {

/// Two coupled contacts that are pressed together, both with friction `mu`.
ContactProblem pair_problem(Real mu) {
    ContactProblem problem;
    problem.name = "pair";
    problem.row_offset = {0, 2, 4};
    problem.column = {0, 1, 0, 1};
    const Mat3 own = Vec3(2, 1.5, 1).asDiagonal(), coupling = 0.4 * Mat3::Identity();
    problem.block = {own, coupling, coupling, own};
    problem.q = {Vec3(-1, 0.8, 0.1), Vec3(-0.5, -0.2, 0.9)};
    problem.mu = {mu, mu};
    return problem;
}

}  // namespace

TEST_CASE("over-relaxation outside of its range is refused, inside it changes the path and not the solution",
          "[unit][problem]") {
    for (const Real wrong : {0.0, 2.0, -1.0, std::nan("")}) {
        CHECK(message_of([&] { solve_problem(pair_problem(0.3), {.relaxation = wrong}); }).find("relaxation") !=
              std::string::npos);
        CHECK(message_of([&] { tuned_world({}, {.relaxation = wrong}); }).find("relaxation") != std::string::npos);
    }
    const ProblemSettings plain{.method = SolverMethod::pgs, .tolerance = 1e-12};
    ProblemSettings relaxed = plain;
    relaxed.relaxation = 1.3;
    const ProblemSolution one = solve_problem(pair_problem(0.3), plain),
                          other = solve_problem(pair_problem(0.3), relaxed);
    CHECK(one.converged);
    CHECK(other.converged);
    CHECK(one.iterations != other.iterations);
    for (std::size_t i = 0; i < 2; ++i) CHECK((one.reaction[i] - other.reaction[i]).norm() < 1e-10);
}

TEST_CASE("the settings of a world reach its contact solver, and have the same defaults", "[unit][solver]") {
    CHECK(solver_settings(Settings{}, Tuning{}) == SolverSettings{});

    Settings settings;
    Tuning tuning;
    SolverSettings expected;
    settings.method = expected.method = SolverMethod::pgs;
    settings.friction = expected.friction = Friction::pyramid;
    tuning.warm_start = expected.warm_start = WarmStart::off;
    settings.tolerance = expected.tolerance = 1e-7;
    settings.max_iterations = expected.max_iterations = 17;
    tuning.fixed_iterations = expected.fixed_iterations = true;
    tuning.relaxation = expected.relaxation = 1.3;
    tuning.restitution_speed = expected.restitution_speed = 0.7;
    settings.recovery_speed = expected.recovery_speed = 0.9;
    tuning.certify_warm_start = expected.certify_warm_start = false;
    tuning.skip_separating = expected.skip_separating = false;
    tuning.frictionless_rows = expected.frictionless_rows = false;
    tuning.small_regions_in_lanes = expected.small_regions_in_lanes = false;
    CHECK(solver_settings(settings, tuning) == expected);
}

}  // namespace skerry::test::method_settings_test
