#include "systems/solver/local/friction_law.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

namespace skerry::test::friction_law_test {

namespace {

struct Draw {
    std::mt19937 random{17};
    std::normal_distribution<Real> number;

    Vec3 vector() { return {number(random), number(random), number(random)}; }
};

}  // namespace

TEST_CASE("the cone projection leaves a point of the cone and a remainder of its polar, at right angles",
          "[property][solver]") {
    Draw draw;
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3 normal = draw.vector().normalized(), z = draw.vector();
        const Real mu = trial % 5 == 0 ? 0 : std::abs(draw.number(draw.random));
        const Vec3 p = project_onto_cone(z, normal, mu), rest = z - p;
        const Real along = p.dot(normal), rest_along = rest.dot(normal);
        REQUIRE((p - along * normal).norm() <= mu * along + 1e-13);
        REQUIRE(mu * (rest - rest_along * normal).norm() <= -rest_along + 1e-12 * (1 + mu));
        REQUIRE(std::abs(p.dot(rest)) <= 1e-13 * (1 + z.squaredNorm()));
        REQUIRE((project_onto_cone(p, normal, mu) - p).norm() <= 1e-13 * (1 + z.norm()));
    }
}

// Without friction the cone is a half line, and a pull along the normal lies on its backward extension.
TEST_CASE("no projection leaves a pull, along the normal and without friction too", "[unit][solver]") {
    const Vec3 normal = Vec3::UnitX(), pull = -2 * normal;
    const FrictionLimits mu{0, 0};
    CHECK(project_onto_cone(pull, normal, 0) == Vec3::Zero());
    for (const Friction friction : {Friction::cone, Friction::pyramid})
        CHECK(project_friction(pull, normal, mu, friction) == Vec3::Zero());
}

TEST_CASE("Coulomb's projection keeps the normal part and cuts the tangential part along itself",
          "[property][solver]") {
    Draw draw;
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3 normal = draw.vector().normalized(), z = draw.vector();
        const Real mu = std::abs(draw.number(draw.random));
        const Vec3 p = project_coulomb(z, normal, {mu, mu});
        const Real along = z.dot(normal);
        if (along <= 0) {
            REQUIRE(p == Vec3::Zero());
            continue;
        }
        const Vec3 tangential = z - along * normal, kept = p - p.dot(normal) * normal;
        REQUIRE(p.dot(normal) == Approx(along).epsilon(1e-12));
        REQUIRE(kept.norm() == Approx(std::min(tangential.norm(), mu * along)).margin(1e-13));
        REQUIRE(kept.cross(tangential).norm() <= 1e-13);
        REQUIRE((project_coulomb(padded(z), padded(normal), {mu, mu}).head<3>() - p).norm() <= 1e-15 * z.norm() * 4);
    }
}

TEST_CASE("static friction decides whether to slide, dynamic friction how much is left", "[unit][solver]") {
    const Vec3 up = Vec3::UnitZ();
    CHECK(project_coulomb(Vec3(0.49, 0, 1), up, {0.5, 0.3}) == Vec3(0.49, 0, 1));
    CHECK((project_coulomb(Vec3(0.51, 0, 1), up, {0.5, 0.3}) - Vec3(0.3, 0, 1)).norm() < 1e-15);
    CHECK((project_pyramid(Vec3(0.51, 0.49, 1), up, {0.5, 0.3}) - Vec3(0.3, 0.49, 1)).norm() < 1e-15);
    CHECK((project_coulomb(Vec3(2, 0, 1), up, {0, 0}) - Vec3(0, 0, 1)).norm() == 0);
}

TEST_CASE("the pyramid is a box in the tangent frame", "[unit][solver]") {
    const Vec3 up = Vec3::UnitZ();
    CHECK((project_pyramid(Vec3(3, -4, 1), up, {0.5, 0.5}) - Vec3(0.5, -0.5, 1)).norm() < 1e-15);
    CHECK((project_pyramid(Vec3(0.1, -4, 1), up, {0.5, 0.5}) - Vec3(0.1, -0.5, 1)).norm() < 1e-15);
    CHECK(project_pyramid(Vec3(1, 1, -1), up, {0.5, 0.5}) == Vec3::Zero());
}

TEST_CASE("not-a-number is not projected away", "[unit][solver]") {
    const Vec3 bad(0, 0, std::numeric_limits<Real>::quiet_NaN());
    CHECK(std::isnan(project_coulomb(bad, Vec3(Vec3::UnitZ()), {0.5, 0.5}).sum()));
    CHECK(std::isnan(project_pyramid(bad, Vec3(Vec3::UnitZ()), {0.5, 0.5}).sum()));
    CHECK(std::isnan(project_onto_cone(bad, Vec3(Vec3::UnitZ()), 0.5).sum()));
}

TEST_CASE("the residual is kept only where the impulse may move", "[unit][solver]") {
    const Vec3 up = Vec3::UnitZ(), residual(1, 2, 3);
    const FrictionLimits mu{0.5, 0.5};
    const auto feasible = [&](const Vec3& impulse, const Vec3& r, Friction friction) {
        return feasible_direction(r, impulse, up, mu, friction);
    };
    CHECK(feasible({0, 0, 0}, residual, Friction::cone) == Vec3(0, 0, 3));
    CHECK(feasible({0, 0, 0}, -residual, Friction::cone) == Vec3::Zero());
    CHECK(feasible({0.1, 0, 1}, residual, Friction::cone) == residual);
    CHECK(feasible({0.5, 0, 1}, residual, Friction::cone) == Vec3(0, 2, 3));
    CHECK(feasible({-0.5, 0, 1}, residual, Friction::cone) == residual);
    CHECK(feasible({0.5, 0.1, 1}, residual, Friction::pyramid) == Vec3(0, 2, 3));
    CHECK(feasible({-0.5, 0.5, 1}, residual, Friction::pyramid) == Vec3(1, 0, 3));
}

}  // namespace skerry::test::friction_law_test
