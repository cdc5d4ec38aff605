#include "systems/solver/operators/block_operator.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <random>
#include <vector>

#include "systems/solver/methods/run_method.h"

using namespace skerry;

namespace {

/// A dense random problem: W = G G^T, every contact with every other.
struct DenseProblem {
    std::vector<Index> row_offset, column, all;
    std::vector<Mat3> block;
    std::vector<Vec3> q;
    std::vector<Real> mu;

    DenseProblem(int contacts, int freedoms, Real friction, unsigned seed) {
        std::mt19937 random(seed);
        std::normal_distribution<Real> number;
        Eigen::MatrixXd g(3 * contacts, freedoms);
        for (Eigen::Index i = 0; i < g.size(); ++i) g.data()[i] = number(random);
        const Eigen::MatrixXd w = g * g.transpose();
        Eigen::VectorXd v(freedoms);
        for (Eigen::Index i = 0; i < freedoms; ++i) v[i] = number(random);
        const Eigen::VectorXd free = g * v;  // in the range of W, so that a solution exists
        row_offset.push_back(0);
        for (int i = 0; i < contacts; ++i) {
            for (int j = 0; j < contacts; ++j) {
                column.push_back(j);
                block.emplace_back(w.block<3, 3>(3 * i, 3 * j));
            }
            row_offset.push_back(static_cast<Index>(column.size()));
            q.emplace_back(free.segment<3>(3 * i));
            mu.push_back(friction);
            all.push_back(i);
        }
    }
    BlockSystem view() const { return {row_offset, column, block, q, mu}; }
};

}  // namespace

TEST_CASE("every method solves dense random blocks with cone and pyramid", "[unit][solver]") {
    for (const auto& [method, name] : EnumNames<SolverMethod>::table)
        for (const Friction friction : {Friction::cone, Friction::pyramid})
            for (unsigned seed = 0; seed < 10; ++seed) {
                const DenseProblem problem(6, 30, 0.4, seed);
                const BlockSystem system = problem.view();
                BlockMemory memory;
                memory.prepare(system, problem.all);
                BlockOperator op(memory, 0, 6, friction, 0);
                const SolveResult result = run_method(method, op, {1e-8, 20000, false, 1});
                INFO(name_of(method) << " " << name_of(friction) << " seed " << seed << " error " << result.error);
                CHECK(result.converged);
                // looked at again, from W and r alone
                for (std::size_t i = 0; i < 6; ++i) {
                    Vec3 u = problem.q[i];
                    for (std::size_t j = 0; j < 6; ++j) u += problem.block[6 * i + j] * memory.impulse[j].head<3>();
                    const Vec3 r = memory.impulse[i].head<3>();
                    const Real size = 1 + u.norm();
                    CHECK(r[0] >= 0);
                    CHECK(u[0] > -1e-6 * size);
                    CHECK(std::abs(r[0] * u[0]) < 1e-5 * size);
                    const Real load = friction == Friction::cone ? std::hypot(r[1], r[2]) : std::max(std::abs(r[1]), std::abs(r[2]));
                    CHECK(load <= 0.4 * r[0] * (1 + 1e-12));
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
