// Shots at up to 100 m/s: nothing goes through anything.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/support/shots.h"

using namespace skerry::test;
using namespace skerry::test::shots;

namespace {

/// `touching`: how many at least hit what they are aimed at; `stopped`: how often at least one would have gone through;
/// `crossed`: features that at most went through in a step that no try could stop, which is told, and came back.
void check_all_stopped(const Count& count, std::uint64_t touching, std::uint64_t stopped, std::uint64_t crossed = 0) {
    INFO("seed " << seed);
    CHECK(count.wrong == "");
    CHECK(count.crossed <= crossed);
    CHECK(count.touching > touching);
    CHECK(count.stopped > stopped);
}

/// A cylinder that turns by a tenth of a radian in a step and more is not always held off the rim of a bucket whose
/// wall is a millimetre thick: it is pressed into it by a tenth of that (docs/methods/rigid_bodies.md 6.3).
void check_few_pressed(const Count& count, std::uint64_t pressed, std::uint64_t touching) {
    INFO("seed " << seed << "\n" << count.wrong);
    CHECK(static_cast<std::uint64_t>(std::ranges::count(count.wrong, '\n')) == count.pressed);
    CHECK(count.pressed <= pressed);
    CHECK(count.touching > touching);
}

}  // namespace

TEST_CASE("of 1,000 shots at up to 100 m/s all are stopped", "[scene][slow]") {
    check_all_stopped(shoot(1000, true), 950, 1000);
}

TEST_CASE("of 1,000 mesh colliders at up to 100 m/s, whose velocity is set anew all the time, none goes through",
          "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::collider, Targets::surfaces), 900, 300);
}

TEST_CASE("of 1,000 shots at thin and sharp analytic colliders all are stopped", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::shot, Targets::shapes), 900, 300);
}

TEST_CASE("of 1,000 analytic colliders at up to 100 m/s, whose velocity is set anew all the time, none goes through",
          "[scene][slow]") {
    // a ball of 84 kPa that meets a bead at 87 m/s, ten times as fast as its own waves
    check_all_stopped(shoot(1000, true, Flying::collider, Targets::shapes), 800, 300, 1);
}

TEST_CASE("of 150 spheres at up to 100 m/s no surface comes into what they are shot at", "[scene]") {
    check_all_stopped(shoot(150, true, Flying::shot, Targets::all, Bullets::spheres), 135, 50);
}

TEST_CASE("of 1,000 spheres at up to 100 m/s no surface comes into what they are shot at", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::shot, Targets::all, Bullets::spheres), 900, 300);
}

TEST_CASE("of 1,000 spheres at thin and sharp analytic colliders no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::shot, Targets::shapes, Bullets::spheres), 900, 10);
}

TEST_CASE("of 1,000 mesh colliders that fly at spheres no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::collider, Targets::surfaces, Bullets::spheres), 900, 0);
}

TEST_CASE("without the look at the motion of a step some of the shots come through", "[scene]") {
    INFO("seed " << seed);
    const Count count = shoot(100, false);
    CHECK(count.wrong != "");
    CHECK(count.tests == 0);
}

TEST_CASE("of 150 capsules at up to 100 m/s no surface comes into what they are shot at", "[scene]") {
    check_all_stopped(shoot(150, true, Flying::shot, Targets::all, Bullets::capsules), 140, 50);
}

TEST_CASE("of 1,500 capsules at up to 100 m/s no surface comes into what they are shot at", "[scene][slow]") {
    check_all_stopped(shoot(1500, true, Flying::shot, Targets::all, Bullets::capsules), 1400, 300);
}

TEST_CASE("of 150 capsules at thin and sharp analytic colliders no surface comes into them", "[scene]") {
    check_all_stopped(shoot(150, true, Flying::shot, Targets::shapes, Bullets::capsules), 140, 0);
}

TEST_CASE("of 1,500 capsules at thin and sharp analytic colliders no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(1500, true, Flying::shot, Targets::shapes, Bullets::capsules), 1400, 3);
}

TEST_CASE("of 1,000 mesh colliders that fly at capsules no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::collider, Targets::surfaces, Bullets::capsules), 950, 0);
}

TEST_CASE("of 500 thin and sharp colliders that fly at capsules no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(500, true, Flying::collider, Targets::shapes, Bullets::capsules), 450, 0);
}

TEST_CASE("of 150 cylinders at up to 100 m/s no surface comes into what they are shot at", "[scene]") {
    check_all_stopped(shoot(150, true, Flying::shot, Targets::all, Bullets::cylinders), 140, 50);
}

TEST_CASE("of 1,500 cylinders at up to 100 m/s no surface comes into what they are shot at", "[scene][slow]") {
    check_all_stopped(shoot(1500, true, Flying::shot, Targets::all, Bullets::cylinders), 1400, 300);
}

TEST_CASE("of 150 cylinders at thin and sharp analytic colliders none is seen in them", "[scene]") {
    check_few_pressed(shoot(150, true, Flying::shot, Targets::shapes, Bullets::cylinders), 1, 140);
}

TEST_CASE("of 1,500 cylinders at thin and sharp analytic colliders none is seen in them", "[scene][slow]") {
    check_few_pressed(shoot(1500, true, Flying::shot, Targets::shapes, Bullets::cylinders), 1, 1400);
}

TEST_CASE("of 1,000 mesh colliders that fly at cylinders no surface comes into them", "[scene][slow]") {
    check_all_stopped(shoot(1000, true, Flying::collider, Targets::surfaces, Bullets::cylinders), 950, 0);
}

TEST_CASE("of 500 thin and sharp colliders that fly at cylinders none is seen in them", "[scene][slow]") {
    check_few_pressed(shoot(500, true, Flying::collider, Targets::shapes, Bullets::cylinders), 1, 450);
}
