#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "systems/solver/local/load_contact.h"

namespace skerry::test::midpoint_slip_test {

namespace {

/// Half turn of a node on a floor that slides with `before` at the start of a step and with `now` after the kick.
Vec3 half_turn_of(const Vec3& before, const Vec3& now, const Vec3& floor = Vec3::Zero(), Real friction = 0.5) {
    const Stencil stencil{{0, 0, 0, 0}, {1, 0, 0, 0}};
    const Vec3 normal = Vec3::UnitZ();
    RegionInputs inputs;
    inputs.stencil = {&stencil, 1};
    inputs.normal = {&normal, 1};
    inputs.surface_velocity = {&floor, 1};
    inputs.velocity = {&before, 1};
    inputs.dynamic_friction = {&friction, 1};
    return midpoint_slip(inputs, 0, {&now, 1});
}

}  // namespace

TEST_CASE("friction is directed by the slip halfway through the kick", "[unit][solver]") {
    const Vec3 before(2, 0.1, -0.3), now(1.9, 0.4, -0.5);
    const Vec3 middle = 0.5 * (before + now), seen = now - half_turn_of(before, now);
    const Vec3 along = Vec3(middle.x(), middle.y(), 0).normalized();
    CHECK(seen.z() == now.z());
    // The direction is exact except for the loss of speed by the kick, which is of second order in the angle.
    CHECK(std::abs(along.cross(Vec3(seen.x(), seen.y(), 0).normalized()).z()) < 0.01);
    CHECK(std::abs(along.cross(Vec3(now.x(), now.y(), 0).normalized()).z()) > 0.07);
    const Vec3 floor(5, -3, 0);
    CHECK((half_turn_of(before + floor, now + floor, floor) - half_turn_of(before, now)).norm() < 1e-14);
}

TEST_CASE("between a quarter and half of the speed the turn fades, without a jump", "[unit][solver]") {
    const auto turned_by = [](Real turn) { return half_turn_of({1, 0, 0}, {1, turn, 0}).norm(); };
    // unreduced half turn, perpendicular to the slip
    const auto in_full = [](Real turn) { return 0.5 * turn / std::sqrt(1 + turn * turn); };
    CHECK(turned_by(0.2) == Approx(in_full(0.2)));
    CHECK(turned_by(0.25) == Approx(in_full(0.25)));
    CHECK(turned_by(0.375) == Approx(in_full(0.375) / 2));
    CHECK(turned_by(0.4999) < 1e-3);
    CHECK(turned_by(0.5001) == 0);
}

TEST_CASE("straight motion, rest, stops and reversals keep the friction law", "[unit][solver]") {
    CHECK(half_turn_of({2, 0, -1}, {1.5, 0, -2}).norm() == 0);
    CHECK(half_turn_of({1, 2, 0}, {1.25, 2.5, 0}).norm() < 1e-15);
    CHECK(half_turn_of({0, 0, 0}, {0.01, 0.02, -0.1}).norm() == 0);
    CHECK(half_turn_of({0.1, 0, 0}, {-0.1, 0.05, 0}).norm() == 0);
    CHECK(half_turn_of({2, 0.1, -0.3}, {1.9, 0.4, -0.5}, Vec3::Zero(), 0).norm() == 0);  // no friction
    // The slip turns by more than half of its speed.
    CHECK(half_turn_of({1, 0, 0}, {0.9, 0.6, 0}).norm() == 0);
}

TEST_CASE("a node that turned and is stopped is at rest some steps later", "[unit][solver]") {
    // A node that stops while it turns keeps a half turn: at most a quarter of its slip.
    Vec3 slip(0.4, 0, 0);
    const Vec3 kick(0.01, 0.06, 0);
    for (int step = 0; step < 4; ++step) {
        const Vec3 left = half_turn_of(slip, slip + kick);
        CHECK(left.norm() <= 0.25 * slip.norm());
        slip = left;
    }
    CHECK(slip.norm() == 0);
}

}  // namespace skerry::test::midpoint_slip_test
