#include "systems/solver/local/load_sums.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace skerry::test::load_sums_test {

namespace {

/// A contact of one node of 1 kg with a fixed object, along z.
LumpedContact point_contact(Real coefficient) {
    LumpedContact contact{};
    contact.normal = {0, 0, 1, 0};
    contact.weight = {1, 0, 0, 0};
    contact.step = {1, 0, 0, 0};
    contact.node_count = 1;
    contact.diagonal = contact.inverse_diagonal = 1;
    contact.friction = {coefficient, coefficient};
    return contact;
}

constexpr Real gravity = 10, h = 1e-3, tolerance = 1e-3;

LoadSums sums_of(std::initializer_list<Vec4> velocities) {
    LoadSums sums;
    for (const Vec4& u : velocities) sums.add(point_contact(0.5), Friction::cone, u);
    return sums;
}

}  // namespace

TEST_CASE("the scale of errors is the motion that contacts must stop, not motion along or apart", "[unit][solver]") {
    const Real alone = error_scale(sums_of({{0, 0, -0.02, 0}}), gravity, h, tolerance);
    CHECK(alone == Approx(0.02));
    // projection onto the edge of the cone
    CHECK(error_scale(sums_of({{3, 0, -0.02, 0}}), gravity, h, tolerance) == Approx(0.02 / std::sqrt(1.25)));
    CHECK(error_scale(sums_of({{0, 0, -0.02, 0}, {0, 0, 50, 0}}), gravity, h, tolerance) == Approx(alone));
    CHECK_FALSE(sums_of({{0, 0, -0.02, 0}, {0, 0, 50, 0}}).separating);
}

TEST_CASE("if next to nothing is to be stopped, weight, motion and rounding set the scale of errors",
          "[unit][solver]") {
    const LoadSums slow = sums_of({{0, 0, -1e-9, 0}}), apart = sums_of({{2, 0, 1, 0}});
    CHECK(apart.separating);
    CHECK(error_scale(slow, gravity, h, tolerance) == Approx(1e-3 * gravity * h));
    CHECK(error_scale(apart, 0, h, tolerance) == Approx(1e-6 * std::sqrt(5.0)));
    // A tolerance below the precision of numbers is raised to one that they can represent.
    CHECK(1e-15 * error_scale(apart, 0, h, 1e-15) > 4 * std::numeric_limits<Real>::epsilon());
    CHECK(error_scale(sums_of({{0, 0, 0, 0}}), 0, h, tolerance) == 0);
}

TEST_CASE("sums of parts are those of all, and contacts that nothing can move count for nothing", "[unit][solver]") {
    LoadSums sum = sums_of({{1, 0, -1, 0}});
    sum += sums_of({{0, 2, 1, 0}});
    const LoadSums all = sums_of({{1, 0, -1, 0}, {0, 2, 1, 0}});
    CHECK(sum.squared_residual == all.squared_residual);
    CHECK(sum.moving == all.moving);
    CHECK(sum.inverse_diagonals == 2);
    CHECK_FALSE(sum.separating);
    LumpedContact fixed = point_contact(0.5);
    fixed.node_count = 0;
    fixed.inverse_diagonal = 0;
    LoadSums none;
    none.add(fixed, Friction::cone, {0, 0, -1, 0});
    CHECK(none.separating);
    CHECK(none.moving == 0);
}

}  // namespace skerry::test::load_sums_test
