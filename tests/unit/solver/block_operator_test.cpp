#include "systems/solver/operators/block_operator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "systems/solver/methods/run_method.h"
#include "tests/unit/solver/dense_problem.h"

namespace skerry::test::block_operator_test {

TEST_CASE("every method solves dense random blocks with cone and pyramid", "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid})
            for (unsigned seed = 0; seed < 10; ++seed) {
                constexpr Real mu = 0.4;
                const DenseProblem problem(6, 30, mu, seed);
                const BlockSystem system = problem.view();
                BlockMemory memory;
                memory.prepare(system, problem.all);
                BlockOperator op(memory, 0, 6, friction, 0);
                const Real start = op.error();
                const SolveResult result = run_method(method, op, {1e-8, 20000, false, 1});
                INFO(name_of(method) << " " << name_of(friction) << " seed " << seed << " error " << result.error);
                CHECK(op.error() == result.error);
                // Conjugate gradients alone stagnate where impulses reach their limits.
                const bool stagnates = method == SolverMethod::pcg_fr || method == SolverMethod::pcg_pr;
                if (stagnates) CHECK(result.error <= start);
                if (!stagnates) CHECK(result.converged);
                // This check uses W and r alone.
                for (std::size_t i = 0; i < 6; ++i) {
                    const Vec3 u = problem.velocity(i, memory.impulse);
                    const Vec3 r = memory.impulse[i].head<3>();
                    const Real size = 1 + u.norm();
                    const Real load =
                        friction == Friction::cone ? std::hypot(r[1], r[2]) : std::max(std::abs(r[1]), std::abs(r[2]));
                    CHECK(r[0] >= 0);
                    CHECK(load <= mu * r[0] * (1 + 1e-12));
                    if (stagnates) continue;
                    CHECK(u[0] > -1e-6 * size);
                    CHECK(std::abs(r[0] * u[0]) < 1e-5 * size);
                    CHECK(r[1] * u[1] + r[2] * u[2] < 1e-5 * size);
                }
            }
}

TEST_CASE("over-relaxation comes to the same solution", "[unit][solver]") {
    const DenseProblem problem(5, 30, 0.3, 3);
    const BlockSystem system = problem.view();
    std::vector<Vec4> reaction[2];
    for (int k = 0; k < 2; ++k) {
        BlockMemory memory;
        memory.prepare(system, problem.all);
        BlockOperator op(memory, 0, static_cast<Index>(problem.all.size()), Friction::cone, 0);
        CHECK(solve_pgs(op, {1e-12, 20000, false, k == 0 ? 1.0 : 1.3}).converged);
        reaction[k] = memory.impulse;
    }
    for (std::size_t i = 0; i < 5; ++i) CHECK((reaction[0][i] - reaction[1][i]).norm() < 1e-9);
}

TEST_CASE("the product of the operator is that of its blocks, and leaves the impulses alone", "[unit][solver]") {
    const DenseProblem problem(4, 20, 0.3, 5);
    const BlockSystem system = problem.view();
    BlockMemory memory;
    memory.prepare(system, problem.all);
    BlockOperator op(memory, 0, static_cast<Index>(problem.all.size()), Friction::cone, 0);
    op.sweep(1);
    const std::vector<Vec4> before = memory.impulse;
    std::vector<Vec4> in(4, Vec4(1, -2, 0.5, 0)), out(4);
    op.multiply(in, out);
    CHECK(memory.impulse == before);
    for (std::size_t i = 0; i < 4; ++i) {
        Vec3 expected = Vec3::Zero();
        for (std::size_t j = 0; j < 4; ++j) expected += problem.block[4 * i + j] * in[j].head<3>();
        CHECK((out[i].head<3>() - expected).norm() < 1e-12 * expected.norm());
    }
}

}  // namespace skerry::test::block_operator_test
