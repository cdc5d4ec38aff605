#include "systems/solver/methods/pcg.h"

#include <catch2/catch.hpp>

#include "systems/solver/operators/lumped_operator.h"
#include "tests/support/contact_scene.h"

namespace skerry::test::pcg_pgs_test {

TEST_CASE("the paper's combination comes to the solution of Gauss-Seidel alone", "[unit][solver]") {
    for (const Friction friction : {Friction::cone, Friction::pyramid})
        for (unsigned seed = 0; seed < 4; ++seed) {
            ContactScene scene;
            add_sheets(scene, 6, 0.4, seed);
            SolverSettings settings;
            settings.friction = friction;
            settings.tolerance = 1e-10;
            settings.max_iterations = 50000;
            const SolvedScene pgs = scene.solve(settings);
            settings.method = SolverMethod::pcg_pgs;
            const SolvedScene combined = scene.solve(settings);
            REQUIRE(pgs.regions.status[0] == RegionStatus::converged);
            REQUIRE(combined.regions.status[0] == RegionStatus::converged);
            for (std::size_t n = 0; n < pgs.velocity.size(); ++n)
                REQUIRE((pgs.velocity[n] - combined.velocity[n]).norm() < 1e-6);
        }
}

TEST_CASE("the combination never takes more iterations than allowed and returns its best", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 10, 0.5, 3);
    SolverSettings settings;
    settings.method = SolverMethod::pcg_pgs;
    settings.tolerance = 1e-12;
    for (const Index limit : {1, 2, 5, 40}) {
        settings.max_iterations = limit;
        const SolvedScene solved = scene.solve(settings);
        CHECK(solved.regions.iterations[0] == limit);
        CHECK(solved.regions.status[0] == RegionStatus::iteration_limit);
        CHECK(solved.regions.error[0] < 1);  // never worse than the start from zero
    }
}

TEST_CASE("conjugate gradients are exact where nothing is projected", "[unit][solver]") {
    // A stack that is pressed together everywhere: the bounds never act, and 6 unknowns need 6 iterations.
    constexpr int height = 6;
    std::vector<LumpedContact> contact(height);
    std::vector<Vec4> velocity(height), impulse(height, Vec4::Zero()), scratch(height), space[4];
    std::vector<Index> node(height);
    std::vector<Vec3> free(height, Vec3(0, 0, -1));
    for (int i = 0; i < height; ++i) {
        const auto k = static_cast<std::size_t>(i);
        node[k] = i;
        velocity[k] = padded(free[k]);
        contact[k].normal = Vec4(0, 0, 1, 0);
        contact[k].offset = Vec4::Zero();
        contact[k].weight = {1, -1, 0, 0};
        contact[k].step = {1, -1, 0, 0};
        contact[k].node = {i, i - 1, 0, 0};
        contact[k].node_count = i == 0 ? 1 : 2;
        contact[k].diagonal = i == 0 ? 1 : 2;
        contact[k].inverse_diagonal = 1 / contact[k].diagonal;
        contact[k].bias = 0;
        contact[k].friction = {0, 0};
    }
    LumpedMemory memory{{contact, impulse, velocity, node, scratch, {}}, free};
    for (std::size_t slot = 0; slot < 4; ++slot) {
        space[slot].resize(height);
        memory.workspace[slot] = space[slot];
    }
    for (const ConjugateBeta formula : {ConjugateBeta::fletcher_reeves, ConjugateBeta::polak_ribiere}) {
        std::fill(impulse.begin(), impulse.end(), Vec4::Zero());
        LumpedOperator op(memory, Friction::cone, 1);
        op.refresh();
        OperatorView view(op);
        const SolveResult result = solve_pcg_pgs(view, {1e-10, 100, false, 1}, formula);
        CHECK(result.converged);
        CHECK(result.iterations <= height + 1);
        for (int i = 0; i < height; ++i)
            CHECK(impulse[static_cast<std::size_t>(i)].z() == Approx(height - i).epsilon(1e-9));
    }
}

}  // namespace skerry::test::pcg_pgs_test
