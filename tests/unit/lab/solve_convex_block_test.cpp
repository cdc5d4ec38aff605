#include "profiling/lab/solve_convex_block.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/solver/random_block.h"

namespace skerry::test::solve_convex_block_test {

using namespace skerry::lab;

namespace {

Vec3 solve_once(const Mat3& w, const Vec3& b, Real mu) {
    return solve_convex_block(prepare_convex_block(w, mu), b, mu);
}

/// The largest violation of r in K, u in the dual cone, u . r = 0, relative to the sizes of the data.
Real lack(const Mat3& w, const Vec3& b, Real mu, const Vec3& r) {
    const Vec3 u = w * r + b;
    const Real speed = b.norm() + w.norm() * r.norm();
    const Real outside = std::max(Real(0), std::hypot(r[1], r[2]) - mu * r[0]) / (r.norm() + b.norm() / w.norm());
    const Real outside_dual = std::max(Real(0), mu * std::hypot(u[1], u[2]) - u[0]) / speed;
    const Real product = std::abs(u.dot(r)) / (speed * (r.norm() + b.norm() / w.norm()));
    return std::max({outside, outside_dual, product});
}

}  // namespace

TEST_CASE("the convex local solution of 100000 random blocks meets its optimality conditions", "[property][lab]") {
    Draw draw(29);
    Real worst = 0;
    int apart = 0, sticking = 0, sliding = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        const Mat3 w = draw.block(0.3);
        const Vec3 b(2 * draw(), 2 * draw(), 2 * draw());
        const Real mu = std::exp(draw()) * 0.5;
        const Vec3 r = solve_once(w, b, mu);
        worst = std::max(worst, lack(w, b, mu, r));
        if (r.isZero(0)) {
            ++apart;
        } else {
            ++(std::hypot(r[1], r[2]) < mu * r[0] * (1 - 1e-9) ? sticking : sliding);
        }
    }
    CHECK(worst < 1e-11);  // rounding times the condition of a block, which is up to 1e5
    CHECK(std::min({apart, sticking, sliding}) > 5000);
}

TEST_CASE("the convex local solution holds for ill-conditioned blocks and any friction", "[property][lab]") {
    Draw draw(29);
    for (int trial = 0; trial < 20000; ++trial) {
        const Mat3 w = draw.block(3);
        const Vec3 b(draw(), draw(), draw());
        const Real mu = std::exp(2 * draw());
        const Eigen::SelfAdjointEigenSolver<Mat3> eigen(w, Eigen::EigenvaluesOnly);
        const Real condition = eigen.eigenvalues()[2] / eigen.eigenvalues()[0] * std::max(Real(1), mu * mu);
        // rounding times condition
        REQUIRE(lack(w, b, mu, solve_once(w, b, mu)) < std::min(1e-4, 1e-12 + 1e-14 * condition));
    }
}

TEST_CASE("an isotropic block gives the projection onto the cone", "[unit][lab]") {
    // the block is raised by 1e-14 of its trace
    const ConvexBlock block = prepare_convex_block(2 * Mat3::Identity(), 0.5);
    CHECK(solve_convex_block(block, Vec3(3, 3.6, 4.8), 0.5) == Vec3::Zero());  // u_n = mu |u_t|: on the dual cone
    CHECK((solve_convex_block(block, Vec3(-4, 0.6, 0.8), 0.5) - Vec3(2, -0.3, -0.4)).norm() < 1e-13);
    // r_n = (2 + 0.5 * 5) / 1.25
    CHECK((solve_convex_block(block, Vec3(-4, 6, 8), 0.5) - Vec3(3.6, -1.08, -1.44)).norm() < 2e-13);
    // A contact that slides is pressed, even at a normal velocity >= 0.
    CHECK((solve_convex_block(block, Vec3(0, 6, 8), 0.5) - Vec3(2, -0.6, -0.8)).norm() < 1e-13);
    CHECK((solve_convex_block(block, Vec3(1, 6, 8), 0.5) - Vec3(1.6, -0.48, -0.64)).norm() < 1e-13);
}

TEST_CASE("degenerate blocks and zero friction have their convex solutions", "[unit][lab]") {
    CHECK(solve_once(Mat3::Zero(), Vec3(-1, 1, 0), 0.5) == Vec3::Zero());
    Draw draw(29);
    const Mat3 w = draw.block(0.3);
    CHECK((solve_once(w, Vec3(-4, 6, 8), 0) - Vec3(4 / w(0, 0), 0, 0)).norm() < 1e-15);
    CHECK(solve_once(w, Vec3(4, 6, 8), 0) == Vec3::Zero());
    // Rank two: the mobility along the third axis is zero, and the solution does not need it.
    Mat3 flat = Mat3::Zero();
    flat.topLeftCorner<2, 2>() << 2, 0.5, 0.5, 1;
    const Vec3 b(-1, 2, 0);
    CHECK(lack(flat, b, 0.5, solve_once(flat, b, 0.5)) < 1e-12);
    CHECK_FALSE(solve_once(w, Vec3(std::numeric_limits<Real>::quiet_NaN(), 1, 1), 0.5).allFinite());
}

TEST_CASE("the convex local solution does not depend on the unit of the block", "[unit][lab]") {
    Draw draw(29);
    const Mat3 w = draw.block(0.3);
    const Vec3 b(-1, 3, 2);
    const Vec3 r = solve_once(w, b, 0.4);
    for (const Real unit : {1e-12, 1e12})
        CHECK((unit * solve_once(Mat3(unit * w), b, 0.4) - r).norm() < 1e-12 * r.norm());
}

}  // namespace skerry::test::solve_convex_block_test
