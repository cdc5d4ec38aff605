// Limits and motors of joints, against closed forms (docs/methods/joints.md 3).
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/hinged_arm.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::joint_motors_test {

using namespace hinged_arm;

TEST_CASE("a hinge stops at its limits, which carry the weight", "[scene][joints]") {
    Arm arm({.lower = -0.5, .upper = 0.3}, down);
    REQUIRE(arm.world.advance(2).ok());
    CHECK(arm.state().coordinate == Approx(-0.5).epsilon(1e-6));
    CHECK(arm.state().speed == Approx(0).margin(1e-9));
    CHECK((arm.state().moment - Vec3(0, -weight_moment * std::cos(0.5), 0)).norm() < 1e-6 * weight_moment);
    CHECK(arm.state().force.z() == Approx(mass * standard_gravity).epsilon(1e-6));
    arm.world.set_gravity({0, 0, standard_gravity});
    REQUIRE(arm.world.advance(2).ok());
    CHECK(arm.state().coordinate == Approx(0.3).epsilon(1e-6));
    // A joint beyond a limit is moved back to it.
    Joints(arm.world).set_limits(arm.hinge, -0.5, 0.1);
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().coordinate == Approx(0.1).epsilon(1e-6));
    Joints(arm.world).set_limits(arm.hinge, {}, {});
    REQUIRE(arm.world.advance(0.3).ok());
    CHECK(arm.state().coordinate > 0.2);
    CHECK(arm.world.report().energy_error_share < 1e-3);
}

TEST_CASE("a motor speeds up with its strength, and goes on at its speed", "[scene][joints]") {
    const Real strength = 0.5, speed = 4;
    Arm arm({.motor = JointMotor{.speed = speed, .strength = strength}}, Vec3::Zero());
    REQUIRE(arm.world.advance(0.1).ok());
    CHECK(arm.state().speed == Approx(strength / inertia * 0.1).epsilon(1e-4));
    CHECK(arm.state().moment.y() == Approx(-strength).epsilon(1e-4));
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().speed == Approx(speed).epsilon(1e-6));
    CHECK(arm.state().moment.norm() < 1e-3);
    const Real before = arm.state().coordinate;
    REQUIRE(arm.world.advance(5).ok());  // turns by more than three revolutions
    CHECK(arm.state().coordinate - before == Approx(5 * speed).epsilon(1e-4));
    Joints(arm.world).set_motor(arm.hinge, JointMotor{.speed = -1, .strength = 100});
    REQUIRE(arm.world.advance(0.01).ok());
    CHECK(arm.state().speed == Approx(-1).epsilon(1e-4));
    Joints(arm.world).set_motor(arm.hinge, {});
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().speed == Approx(-1).epsilon(1e-3));
    CHECK(arm.world.report().energy_error_share < 1e-3);
}

TEST_CASE("a motor holds a load up to its strength, and a heavier load falls", "[scene][joints]") {
    Arm holds({.motor = JointMotor{.position = 0, .strength = 1.01 * weight_moment}}, down);
    REQUIRE(holds.world.advance(2).ok());
    CHECK(std::abs(holds.state().coordinate) < 1e-9);
    CHECK(holds.state().moment.y() == Approx(-weight_moment).epsilon(1e-6));

    Arm falls({.motor = JointMotor{.position = 0, .strength = 0.4 * weight_moment}}, down);
    REQUIRE(falls.world.advance(0.05).ok());
    CHECK(falls.state().speed == Approx(-0.05 * 0.6 * weight_moment / inertia).epsilon(2e-3));
    CHECK(falls.state().moment.y() == Approx(-0.4 * weight_moment).epsilon(1e-6));
}

TEST_CASE("a motor takes a hinge to a position at its speed, and stops there", "[scene][joints]") {
    const Real target = std::numbers::pi / 3, fastest = 1.5;
    Arm arm({.motor = JointMotor{.position = target, .strength = 50, .fastest = fastest}}, down);
    REQUIRE(arm.world.advance(0.2).ok());
    CHECK(arm.state().coordinate == Approx(0.2 * fastest).epsilon(1e-2));
    CHECK(arm.state().speed == Approx(fastest).epsilon(1e-6));
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().coordinate == Approx(target).epsilon(1e-6));
    CHECK(arm.state().moment.y() == Approx(-weight_moment * std::cos(target)).epsilon(1e-4));
    // A limit on the way overrides the motor.
    Joints(arm.world).set_limits(arm.hinge, -1, 1.2);
    Joints(arm.world).set_motor(arm.hinge, JointMotor{.position = 3, .strength = 50, .fastest = fastest});
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().coordinate == Approx(1.2).epsilon(1e-6));
    Joints(arm.world).set_motor(arm.hinge, JointMotor{.position = 0, .strength = 50});
    REQUIRE(arm.world.advance(0.2).ok());  // it brakes within the motor's strength and does not overshoot
    CHECK(std::abs(arm.state().coordinate) < 1e-6);
    CHECK(std::abs(arm.state().speed) < 1e-6);
}

TEST_CASE("a setter with the present value changes no bit", "[scene][joints]") {
    const JointMotor motor{.speed = 1, .strength = 2};
    Arm arm({.lower = -1, .motor = motor}, down);
    REQUIRE(arm.world.advance(0.2).ok());
    const std::uint64_t before = arm.world.state_hash();
    Joints(arm.world).set_motor(arm.hinge, motor);
    Joints(arm.world).set_limits(arm.hinge, -1, {});
    CHECK(arm.world.state_hash() == before);
    CHECK_THROWS_AS(Joints(arm.world).set_motor(arm.hinge, JointMotor{}), SceneError);
    CHECK_THROWS_AS(Joints(arm.world).set_limits(arm.hinge, 1, 0), SceneError);
    CHECK(arm.world.state_hash() == before);
}

TEST_CASE("a motor with keys follows positions that change linearly between them, and stays before and after them",
          "[scene][joints]") {
    const JointMotor motor{
        .strength = 50,
        .keys = {{.time = 0.2, .position = 0.1}, {.time = 0.7, .position = 0.6}, {.time = 1, .position = 0}}};
    Arm arm({.motor = motor}, down);
    REQUIRE(arm.world.advance(0.2).ok());
    CHECK(arm.state().coordinate == Approx(0.1).epsilon(1e-6));
    REQUIRE(arm.world.advance(0.3).ok());
    // The motor accelerates within its strength and then follows the keys without lag.
    CHECK(arm.state().coordinate == Approx(0.4).epsilon(1e-6));
    CHECK(arm.state().speed == Approx(1).epsilon(1e-6));
    REQUIRE(arm.world.advance(0.4).ok());
    CHECK(arm.state().coordinate == Approx(0.2).epsilon(1e-6));
    CHECK(arm.state().speed == Approx(-2).epsilon(1e-6));
    REQUIRE(arm.world.advance(1).ok());
    CHECK(std::abs(arm.state().coordinate) < 1e-6);
    CHECK(std::abs(arm.state().speed) < 1e-6);
    CHECK(arm.world.report().energy_error_share < 1e-3);
}

TEST_CASE("a motor with keys of speed has the mean speed of the keys in each step", "[scene][joints]") {
    Arm arm({.motor = JointMotor{.strength = 50, .keys = {{.time = 0.5, .speed = 1}, {.time = 1, .speed = -1}}}},
            Vec3::Zero());
    REQUIRE(arm.world.advance(0.5).ok());
    CHECK(arm.state().speed == Approx(1).epsilon(1e-6));
    const Real before = arm.state().coordinate;
    REQUIRE(arm.world.advance(0.5).ok());
    CHECK(arm.state().coordinate == Approx(before).margin(1e-6));
    REQUIRE(arm.world.advance(0.5).ok());
    CHECK(arm.state().speed == Approx(-1).epsilon(1e-6));
    CHECK(arm.state().coordinate == Approx(before - 0.5).margin(1e-6));
}

TEST_CASE("a pulse of speed within one step turns a joint by its mean", "[scene][joints]") {
    const JointMotor motor{
        .strength = 50,
        .keys = {{.time = 3.0005, .speed = 0}, {.time = 3.001, .speed = 1}, {.time = 3.0015, .speed = 0}}};
    Arm arm({.motor = motor}, Vec3::Zero());
    REQUIRE(arm.world.advance(4).ok());
    CHECK(arm.state().coordinate == Approx(0.0005).epsilon(1e-6));
}

TEST_CASE("keys of motors are refused by number, and change nothing", "[scene][joints]") {
    Arm arm({.motor = JointMotor{.strength = 1, .keys = {{.time = 0, .speed = 1}, {.time = 1, .speed = 2}}}}, down);
    REQUIRE(arm.world.advance(0.1).ok());
    const std::uint64_t before = arm.world.state_hash();
    const auto refused = [&](const JointMotor& motor, const std::string& message) {
        CHECK_THROWS_WITH(Joints(arm.world).set_motor(arm.hinge, motor), Catch::Contains(message));
        CHECK(arm.world.state_hash() == before);
    };
    refused({.keys = {{.time = 1, .speed = 1}, {.time = 1, .speed = 2}}},
            "motor.keys[1].time: found 1 s, expected a time after that of the key before, 1 s");
    refused({.keys = {{.time = 0, .speed = 1}, {.time = 1, .position = 2}}}, "motor.keys[1]: found a position");
    refused({.keys = {{.time = 0}}}, "motor.keys[0]: found neither a speed nor a position");
    refused({.speed = 1, .keys = {{.time = 0, .speed = 1}}}, "motor: found more than one of speed, position and keys");
    refused({.keys = {{.time = infinity, .speed = 1}}}, "motor.keys[0].time");
    refused({.keys = {{.time = 0, .position = infinity}}}, "motor.keys[0].position");
}

TEST_CASE("keys of motors are part of the state: equal keys change no bit, others do, and copies and files have them",
          "[scene][joints][determinism]") {
    const auto keys = [](Real last) {
        return JointMotor{.strength = 50, .keys = {{.time = 0, .position = 0}, {.time = 0.4, .position = last}}};
    };
    Arm arm({.motor = keys(1)}, down);
    const JointHandle other =
        Joints(arm.world).add({.kind = JointKind::hinge,
                               .first = arm.body,
                               .axis = {0, -1, 0},
                               .motor = JointMotor{.strength = 0, .keys = {{.time = 7, .speed = 3}}}});
    REQUIRE(arm.world.advance(0.1).ok());
    const std::uint64_t before = arm.world.state_hash();
    Joints(arm.world).set_motor(arm.hinge, keys(1));
    CHECK(arm.world.state_hash() == before);
    Joints(arm.world).set_motor(arm.hinge, keys(2));
    CHECK(arm.world.state_hash() != before);
    Joints(arm.world).set_motor(arm.hinge, keys(1));
    CHECK(arm.world.state_hash() == before);

    const TemporaryFolder folder;
    arm.world.save(folder.path() / "arm.skerry");
    World loaded = World::load(folder.path() / "arm.skerry"), copy = arm.world.clone();
    CHECK(loaded.state_hash() == before);
    for (World* world : {&arm.world, &loaded, &copy}) {
        Joints(*world).remove(other);  // the keys of the motor that stays are found again
        REQUIRE(world->advance(0.5).ok());
    }
    CHECK(arm.state().coordinate == Approx(1).epsilon(1e-6));
    CHECK(loaded.state_hash() == arm.world.state_hash());
    CHECK(copy.state_hash() == arm.world.state_hash());
}

TEST_CASE("a body at rest wakes when the target of its motor changes", "[scene][joints]") {
    const JointMotor motor{.strength = 50, .keys = {{.time = 3, .position = 0}, {.time = 3.5, .position = 0.5}}};
    Arm arm({.motor = motor}, {0, 0, -standard_gravity}, true);
    REQUIRE(arm.world.advance(2.9).ok());
    CHECK(arm.world.report().asleep == 1);
    REQUIRE(arm.world.advance(1).ok());
    CHECK(arm.state().coordinate == Approx(0.5).epsilon(1e-6));
}

TEST_CASE("the moment along the axis is that of the motor and that of the limit", "[scene][joints]") {
    // The motor presses the arm against its upper limit with all its strength. The limit carries the rest.
    Arm arm({.upper = 0.3, .motor = JointMotor{.speed = 1, .strength = 3 * weight_moment}}, down);
    REQUIRE(arm.world.advance(2).ok());
    const Real carried = weight_moment * std::cos(0.3);
    CHECK(arm.state().motor == Approx(3 * weight_moment).epsilon(1e-6));
    CHECK(arm.state().limit == Approx(carried - 3 * weight_moment).epsilon(1e-6));
    Joints(arm.world).set_limits(arm.hinge, {}, {});
    Joints(arm.world).set_motor(arm.hinge, JointMotor{.position = 0.3, .strength = 3 * weight_moment});
    REQUIRE(arm.world.advance(0.5).ok());
    CHECK(arm.state().motor == Approx(carried).epsilon(1e-6));
    CHECK(arm.state().limit == 0);
}

}  // namespace skerry::test::joint_motors_test
