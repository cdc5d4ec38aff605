#include "systems/solver/local/solve_block.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "systems/solver/operators/block_operator.h"
#include "tests/unit/solver/random_block.h"

namespace skerry::test::solve_block_test {

namespace {

Vec3 solve_once(const Mat3& w, const Vec3& b, Real mu) {
    LocalBlock block = prepare_block(w);
    return solve_block(block, b, mu);
}

/// Residual |F| of the natural map with the block's own step, relative to the size of the data.
Real lack(const Mat3& w, const Vec3& b, Real mu, const Vec3& r) {
    const Real step = 1 / w.trace();
    const Vec3 u = w * r + b;
    return natural_map(r, Vec3(step * u), mu, Friction::cone).norm() / (r.norm() + step * b.norm());
}

}  // namespace

TEST_CASE("the local solution of 100000 random blocks solves Coulomb's law", "[property][solver]") {
    Draw draw(23);
    Real worst = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        const Mat3 w = draw.block(0.3);
        const Vec3 b(draw(), 3 * draw(), 3 * draw());
        const Real mu = std::exp(draw()) * 0.5;
        const Vec3 r = solve_once(w, b, mu);
        worst = std::max(worst, lack(w, b, mu, r));
        if (b[0] < 0) REQUIRE(r[0] > 0);
        REQUIRE(std::hypot(r[1], r[2]) <= mu * r[0] * (1 + 1e-14));
    }
    CHECK(worst < 1e-10);  // rounding times the condition of a block, which is up to 1e5
}

TEST_CASE("the local solution holds for ill-conditioned blocks", "[property][solver]") {
    Draw draw(23);
    for (int trial = 0; trial < 20000; ++trial) {
        const Mat3 w = draw.block(3);
        const Vec3 b(-std::abs(draw()), draw(), draw());
        REQUIRE(lack(w, b, 0.7, solve_once(w, b, 0.7)) < 1e-6);
    }
}

TEST_CASE("an isotropic block gives the closed form", "[unit][solver]") {
    LocalBlock block = prepare_block(2 * Mat3::Identity());
    CHECK(solve_block(block, Vec3(1, 5, 5), 0.5) == Vec3::Zero());
    CHECK((solve_block(block, Vec3(-4, 0.6, 0.8), 0.5) - Vec3(2, -0.3, -0.4)).norm() < 1e-15);
    CHECK((solve_block(block, Vec3(-4, 6, 8), 0.5) - Vec3(2, -0.6, -0.8)).norm() < 1e-14);
    CHECK((solve_block(block, Vec3(-4, 6, 8), 0) - Vec3(2, 0, 0)).norm() == 0);
}

TEST_CASE("a block without mobility along the normal gives no impulse", "[unit][solver]") {
    CHECK(solve_once(Mat3::Zero(), Vec3(-1, 1, 0), 0.5) == Vec3::Zero());
}

TEST_CASE("a block of rank one is solved where that is possible", "[unit][solver]") {
    Mat3 w = Mat3::Zero();
    w(0, 0) = 4;
    const Vec3 r = solve_once(w, Vec3(-2, 0, 0), 0.5);
    CHECK((r - Vec3(0.5, 0, 0)).norm() < 1e-15);
    const Vec3 sliding = solve_once(w, Vec3(-2, 1, 0), 0.5);  // the tangent is free: full friction against it
    CHECK((sliding - Vec3(0.5, -0.25, 0)).norm() < 1e-10);
}

TEST_CASE("where the search for the slip starts does not change the solution", "[property][solver]") {
    Draw draw(23);
    for (int trial = 0; trial < 2000; ++trial) {
        const Mat3 w = draw.block(0.3);
        LocalBlock block = prepare_block(w);
        for (int step = 0; step < 5; ++step) {
            const Vec3 b(-std::abs(draw()), 3 * draw(), 3 * draw());
            const Vec3 fresh = solve_once(w, b, 0.3), warm = solve_block(block, b, 0.3);
            REQUIRE((fresh - warm).norm() <= 1e-9 * fresh.norm());
        }
    }
}

}  // namespace skerry::test::solve_block_test
