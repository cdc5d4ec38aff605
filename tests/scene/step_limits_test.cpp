// Causes that limit the length of steps (docs/step_length.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "engine/world/tuning.h"
#include "tests/support/sliver_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::step_limits_test {

namespace {

/// Checks that every step and every shortened try is counted under exactly one cause.
void check_sums(const WorldReport& report) {
    std::uint64_t steps = 0, tries = 0;
    Real seconds = 0;
    for (const StepLimitReport& limit_report : report.step_limits) {
        steps += limit_report.steps;
        tries += limit_report.tries;
        seconds += limit_report.seconds;
    }
    CHECK(steps == report.steps);
    CHECK(tries == report.shortened);
    CHECK(seconds == Approx(report.time).epsilon(1e-9));
}

const StepLimitReport* find(const WorldReport& report, StepLimit limit) {
    for (const StepLimitReport& limit_report : report.step_limits)
        if (limit_report.limit == limit) return &limit_report;
    return nullptr;
}

}  // namespace

TEST_CASE("steps are counted under the body with the shortest stable step", "[scene]") {
    World world;
    const auto soft = world.add_material({.young_modulus = 1e4}), stiff = world.add_material({.young_modulus = 1e6});
    world.add_body(mesh::ball(0.1, 4), {.material = soft, .name = "soft"});
    const auto body = world.add_body(mesh::ball(0.1, 4), {.material = stiff, .position = {1, 0, 0}, .name = "stiff"});
    REQUIRE(world.advance(0.05).ok());
    const WorldReport report = world.report();
    check_sums(report);
    REQUIRE(report.step_limits.size() == 1);
    CHECK(report.step_limits[0].limit == StepLimit::rest);
    CHECK(report.step_limits[0].body == body);
    CHECK(report.step_limits[0].body_name == "stiff");
}

TEST_CASE("steps that the settings keep short are counted under them", "[scene]") {
    Settings settings;
    settings.step_size = 1e-5;
    World world(settings);
    world.add_body(mesh::ball(0.1, 4), {.material = world.add_material({.young_modulus = 1e4})});
    REQUIRE(world.advance(1e-3).ok());
    const WorldReport report = world.report();
    check_sums(report);
    REQUIRE(report.step_limits.size() == 1);
    CHECK(report.step_limits[0].limit == StepLimit::setting);
    CHECK(report.step_limits[0].body_name.empty());
}

TEST_CASE("what deforms evenly is as fast as steps may be, and no try is in vain", "[scene]") {
    World world(Settings{.gravity = Vec3::Zero()});
    const auto body = world.add_body(mesh::ball(0.1, 4), {.material = world.add_material({.young_modulus = 1e4})});
    const Real rate =
        4 * Tuning{}.max_strain_step / world.stable_step() / std::sqrt(3.0);  // |F'| is four times the allowed one
    std::vector<Vec3> velocity;
    for (const Vec3& x : world.positions(body)) velocity.push_back(rate * x);
    world.set_velocities(body, velocity);
    REQUIRE(world.advance(world.stable_step()).ok());
    const WorldReport report = world.report();
    check_sums(report);
    CHECK(report.shortened == 0);
    CHECK(report.steps >= 5);
    CHECK(report.steps <= 8);
    const StepLimitReport* speed = find(report, StepLimit::speed);
    REQUIRE(speed != nullptr);
    CHECK(speed->steps == report.steps);
    CHECK(speed->body == body);
}

TEST_CASE("a body that is thrown hard counts for what it makes of the steps", "[scene]") {
    // The body hits at 1.4 times its speed of sound: elements are crushed and inverted, and the steps grow back.
    World world;
    world.add_collider(Plane{});
    const auto body =
        world.add_body(mesh::box({0.1, 0.1, 0.1}, {5, 5, 5}),
                       {.material = world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.3, .friction = 0.4}),
                        .position = {0, 0, 0.08},
                        .rotation = {0.3, 0.5, 0.1},
                        .velocity = {0, 0, -10},
                        .name = "thrown"});
    REQUIRE(world.advance(0.1).ok());
    const WorldReport report = world.report();
    REQUIRE(report.shortened > 0);
    check_sums(report);
    std::uint64_t shortened_steps = 0;
    for (const StepLimit limit : {StepLimit::speed, StepLimit::inversion, StepLimit::crossing})
        if (const StepLimitReport* limit_report = find(report, limit)) {
            shortened_steps += limit_report->steps;
            CHECK(limit_report->tries > 0);
            if (limit != StepLimit::crossing) CHECK(limit_report->body == body);
        }
    CHECK(shortened_steps >= report.shortened);
    CHECK(std::ranges::is_sorted(report.step_limits, std::greater{}, &StepLimitReport::steps));
}

TEST_CASE("no step is shortened for slivers that turn over", "[scene]") {
    World world;
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.4, .friction = 0.4});
    world.add_collider(Plane{});
    world.add_body(test::sliver_box(0.1, 6, 0.01, 0.02),
                   {.material = rubber, .position = {0, 0, 0.06}, .velocity = {0, 0, -1.5}});
    REQUIRE(world.advance(0.1).ok());
    const WorldReport report = world.report();
    CHECK(report.inversions > 10);
    for (const StepLimitReport& limit_report : report.step_limits) CHECK(limit_report.limit != StepLimit::inversion);
}

}  // namespace skerry::test::step_limits_test
