// Springs, dampers and dry friction of joints, against closed forms (docs/methods/joints.md 4).
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "systems/solver/local/joint_law.h"
#include "tests/support/hinged_arm.h"

namespace skerry::test::joint_passive_test {

using namespace hinged_arm;
using Catch::Matchers::Contains;

TEST_CASE("a torsion spring swings at its frequency, without losses", "[scene][joints]") {
    const Real frequency = 4 * std::numbers::pi, rest = 0.1;
    Arm arm(JointSettings{.passive = {.stiffness = inertia * frequency * frequency, .rest = rest}});
    for (int quarter = 1; quarter <= 40; ++quarter) {
        REQUIRE(arm.world.advance(0.125).ok());
        // Velocities of the symplectic Euler method are half a step behind positions.
        const Real expected = rest * (1 - std::cos(frequency * (quarter * 0.125 - step / 2)));
        INFO("after " << quarter << " quarters of a period");
        CHECK(arm.state().coordinate == Approx(expected).margin(0.03 * rest));
    }
    // The amplitude of the tenth period is that of the first.
    Real most = 0;
    for (int k = 0; k < 250; ++k) {
        REQUIRE(arm.world.advance(step).ok());
        most = std::max(most, arm.state().coordinate);
    }
    CHECK(most == Approx(2 * rest).epsilon(1e-3));
}

TEST_CASE("a spring carries the weight at the same angle for any step", "[scene][joints]") {
    const Real stiffness = 20 * weight_moment;
    for (const Real scale : {1.0, 100.0, 1e6}) {
        Arm arm(JointSettings{.passive = {.stiffness = scale * stiffness, .damping = std::sqrt(scale) * 0.5}}, down);
        REQUIRE(arm.world.advance(4).ok());
        const Real angle = arm.state().coordinate;
        INFO("stiffness " << scale * stiffness << " N m/rad");
        CHECK(-scale * stiffness * angle == Approx(weight_moment * std::cos(angle)).epsilon(1e-6));
        CHECK(arm.state().passive == Approx(weight_moment * std::cos(angle)).epsilon(1e-6));
        CHECK(arm.state().motor == 0);
        CHECK(arm.state().limit == Approx(0).margin(1e-9));
        CHECK(arm.world.report().energy_error_share < 1e-2);
    }
}

TEST_CASE("a damper slows a joint exponentially", "[scene][joints]") {
    const Real rate = 3;  // [1/s]
    Arm arm(JointSettings{.passive = {.damping = rate * inertia}});
    arm.spin(5);
    REQUIRE(arm.world.advance(1).ok());
    // the decay of the implicit step, which is of first order
    CHECK(arm.state().speed == Approx(5 * std::pow(1 + step * rate, -500)).epsilon(1e-4));
    CHECK(arm.state().speed == Approx(5 * std::exp(-rate)).epsilon(1e-2));
    CHECK(arm.state().passive == Approx(-rate * inertia * arm.state().speed).epsilon(1e-6));
}

TEST_CASE("dry friction stops a joint and holds it", "[scene][joints]") {
    const Real friction = 0.5 * weight_moment;
    Arm arm(JointSettings{.passive = {.friction = friction}});
    arm.spin(2);
    const Real stop = 2 * inertia / friction;  // [s]
    const Real before = std::floor(stop / 2 / step) * step;
    REQUIRE(arm.world.advance(before).ok());
    CHECK(arm.state().speed == Approx(2 - friction / inertia * before).epsilon(1e-4));
    CHECK(arm.state().passive == Approx(-friction).epsilon(1e-4));
    REQUIRE(arm.world.advance(stop).ok());
    CHECK(arm.state().speed == Approx(0).margin(1e-9));
    const Real angle = arm.state().coordinate;
    // A smaller moment does not move the joint, and a larger one does.
    arm.world.set_gravity(Vec3(0, 0, -0.4 * standard_gravity));
    REQUIRE(arm.world.advance(2).ok());
    CHECK(arm.state().coordinate == Approx(angle).margin(1e-8));
    CHECK(arm.state().passive == Approx(0.4 * weight_moment * std::cos(angle)).epsilon(1e-6));
    arm.world.set_gravity(down);
    REQUIRE(arm.world.advance(0.5).ok());
    CHECK(arm.state().coordinate < angle - 0.1);
    CHECK(arm.world.report().energy_error_share < 1e-3);
}

TEST_CASE("a motor works against friction, and reports list the parts of the moment", "[scene][joints][long]") {
    const Real strength = 0.5, friction = 0.2;
    for (const Real sign : {1.0, -1.0}) {
        Arm arm(JointSettings{.motor = JointMotor{.speed = 4 * sign, .strength = strength},
                              .passive = {.friction = friction}});
        REQUIRE(arm.world.advance(0.1).ok());
        CHECK(arm.state().speed == Approx(sign * (strength - friction) / inertia * 0.1).epsilon(1e-4));
        CHECK(arm.state().motor == Approx(sign * strength).epsilon(1e-6));
        CHECK(arm.state().passive == Approx(-sign * friction).epsilon(1e-6));
        REQUIRE(arm.world.advance(2).ok());
        CHECK(arm.state().speed == Approx(4 * sign).epsilon(1e-6));
        CHECK(arm.state().motor == Approx(sign * friction).epsilon(1e-3));
    }
    // A spring that presses against a limit.
    Arm arm(JointSettings{.upper = 0.1, .passive = {.stiffness = 2, .rest = 0.6, .damping = 0.1}});
    REQUIRE(arm.world.advance(2).ok());
    CHECK(arm.state().coordinate == Approx(0.1).epsilon(1e-6));
    CHECK(arm.state().passive == Approx(1.0).epsilon(1e-6));
    CHECK(arm.state().limit == Approx(-1.0).epsilon(1e-6));
}

TEST_CASE("passive forces are settings of the joint that can be read, changed and saved", "[scene][joints]") {
    Arm arm(JointSettings{.lower = -1,
                          .motor = JointMotor{.position = 0.5, .strength = 2, .fastest = 3},
                          .passive = {.stiffness = 1, .rest = 2, .damping = 3, .friction = 4}});
    Joints joints(arm.world);
    CHECK(joints.passive(arm.hinge) == JointPassive{.stiffness = 1, .rest = 2, .damping = 3, .friction = 4});
    CHECK(joints.limits(arm.hinge).lower == -1.0);
    CHECK_FALSE(joints.limits(arm.hinge).upper.has_value());
    const std::optional<JointMotor> motor = joints.motor(arm.hinge);
    REQUIRE(motor.has_value());
    CHECK((motor->position == 0.5 && !motor->speed && motor->strength == 2 && motor->fastest == 3));
    joints.set_motor(arm.hinge, JointMotor{.strength = 1, .keys = {{.time = 0, .speed = 1}, {.time = 2, .speed = 3}}});
    REQUIRE(joints.motor(arm.hinge)->keys.size() == 2);
    CHECK(joints.motor(arm.hinge)->keys[1].speed == 3.0);
    CHECK_FALSE(joints.motor(arm.hinge)->speed.has_value());
    joints.set_motor(arm.hinge, {});
    CHECK_FALSE(joints.motor(arm.hinge).has_value());

    REQUIRE(arm.world.advance(0.05).ok());
    World copy = World::from_bytes(arm.world.to_bytes());
    REQUIRE(copy.advance(0.05).ok());
    REQUIRE(arm.world.advance(0.05).ok());
    CHECK(copy.state_hash() == arm.world.state_hash());
    CHECK_THROWS_WITH(joints.set_passive(arm.hinge, {.damping = -1}), Contains("passive.damping") && Contains("-1"));
    CHECK(joints.passive(arm.hinge).damping == 3);
    const JointHandle ball = joints.add({.kind = JointKind::ball, .first = arm.body});
    CHECK_THROWS_WITH(joints.set_passive(ball, {}), Contains("a ball joint"));
    CHECK_THROWS_WITH(joints.add({.kind = JointKind::fixed, .first = arm.body, .passive = {.friction = 1}}),
                      Contains("passive forces on a hinge or slider"));
}

TEST_CASE("a sleeping joint wakes when its spring changes", "[scene][joints]") {
    Arm arm(JointSettings{.passive = {.stiffness = 2, .damping = 0.2}}, Vec3(0, 0, -0.1), true);
    REQUIRE(arm.world.advance(4).ok());
    REQUIRE(arm.world.asleep(arm.body));
    Joints(arm.world).set_passive(arm.hinge, {.stiffness = 2, .damping = 0.2});
    CHECK(arm.world.asleep(arm.body));
    Joints(arm.world).set_passive(arm.hinge, {.stiffness = 2, .rest = 0.3, .damping = 0.2});
    REQUIRE(arm.world.advance(3).ok());
    CHECK(arm.state().coordinate == Approx(0.3 - 0.1 / standard_gravity * weight_moment / 2).epsilon(1e-2));
}

TEST_CASE("the impulse of an axis solves the law of all its forces", "[unit][joints]") {
    std::mt19937 random(1);
    std::uniform_real_distribution<Real> any(-1, 1);
    std::uniform_int_distribution<int> coin(0, 1);
    for (int draw = 0; draw < 20000; ++draw) {
        AxisBounds axis;
        axis.target = any(random);
        axis.max_impulse = coin(random) * std::abs(any(random));
        axis.friction = coin(random) * std::abs(any(random));
        axis.pull = coin(random) * any(random);
        axis.drag = coin(random) * std::abs(any(random));
        if (coin(random)) axis.low = -std::abs(any(random));
        if (coin(random)) axis.high = std::abs(any(random));
        const Real w = 0.1 + std::abs(any(random)), b = 3 * any(random);
        const Real r = solve_axis(axis, w, b), u = b + w * r;
        constexpr Real rounding = 1e-12;
        REQUIRE((u >= axis.low - rounding && u <= axis.high + rounding));
        const AxisImpulses parts = parts_of(axis, w, u, r);
        const Real friction = parts.passive - (axis.pull - axis.drag * u), limit = r - parts.motor - parts.passive;
        // Each drive has its full strength toward its target, or holds the target.
        const auto is_drive = [&](Real impulse, Real target, Real most) {
            const Real full = u < target ? most : -most;
            return std::abs(impulse) <= most + rounding &&
                   (std::abs(u - target) < 1e-9 || std::abs(impulse - full) < 1e-9);
        };
        INFO("draw " << draw);
        const bool at_limit = u < axis.low + rounding || u > axis.high - rounding;
        if (!at_limit) {
            CHECK(is_drive(parts.motor, axis.target, axis.max_impulse));
            CHECK(is_drive(friction, 0, axis.friction));
            CHECK(limit == Approx(0).margin(1e-9));
        } else {
            CHECK((u < 0 ? limit : -limit) >= -1e-9);
        }
    }
}

}  // namespace skerry::test::joint_passive_test
