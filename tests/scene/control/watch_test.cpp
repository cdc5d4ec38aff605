// The callback that runs after every step.
#include <catch2/catch.hpp>

#include <stdexcept>

#include "tests/support/worlds.h"

namespace skerry::test::watch_test {

TEST_CASE("after every committed step positions, contacts and queries can be looked at, and nothing be set",
          "[scene]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings;
        settings.integrator = integrator;
        BlockOnPlane scene(settings, {.young_modulus = 1e5});
        World& world = scene.world;
        int calls = 0, with_contacts = 0;
        Real impulse = 0, height = -1;
        world.watch_steps([&](const StepReport& report) {
            CHECK(report.steps == ++calls);
            with_contacts += !world.contacts().empty();
            for (const Contact& contact : world.contacts()) impulse += contact.impulse.z();
            const Real z = world.center_of_mass(scene.block).z();
            CHECK(z != height);
            height = z;
            const auto hit = world.cast_ray({0.01, 0.02, 1}, {0, 0, -1}, 2);
            REQUIRE(hit);
            CHECK(hit->body == scene.block);
            CHECK(hit->point.z() == Approx(z + 0.05).margin(1e-3));
            CHECK_THROWS_AS(world.set_gravity({0, 0, 0}), SceneError);
            CHECK_THROWS_AS(world.set_loads(scene.block, {}), SceneError);
            CHECK_THROWS_AS(world.set_velocity(world.colliders()[0], {0, 0, 1}), SceneError);
            CHECK_THROWS_AS(world.advance(1), SceneError);
        });
        const StepReport report = world.advance(0.2);
        REQUIRE(report.ok());
        CHECK(calls == report.steps);
        CHECK(with_contacts > calls / 2);
        CHECK(impulse == Approx(0.2 * 9.81 * world.mass(scene.block)).epsilon(0.05));
        world.watch_steps({});
        REQUIRE(world.advance(0.01).ok());
        CHECK(calls == report.steps);
    }
}

TEST_CASE("a watcher changes no bit, and its exception ends the run between two steps", "[scene][determinism]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings;
        settings.integrator = integrator;
        settings.step_size = 1e-4;
        BlockOnPlane watched(settings, {.young_modulus = 1e5}), other(settings, {.young_modulus = 1e5});
        watched.world.watch_steps([](const StepReport& report) {
            if (report.steps == 30) throw std::runtime_error("enough");
        });
        CHECK_THROWS_WITH(watched.world.advance(0.01), "enough");
        CHECK(watched.world.time() == Approx(30e-4));
        watched.world.watch_steps({});
        int tries = 0;
        REQUIRE(
            other.world.advance(0.01, [&](const StepReport& report) { return ++tries, report.steps < 30; }).status ==
            StepStatus::stopped);
        CHECK(watched.world.state_hash() == other.world.state_hash());
        REQUIRE(watched.world.advance(0.01).ok());
        REQUIRE(other.world.advance(0.01).ok());
        CHECK(watched.world.state_hash() == other.world.state_hash());
    }
}

}  // namespace skerry::test::watch_test
