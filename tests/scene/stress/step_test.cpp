// Stress suite: steps that are too long, bodies that are too far away, numbers that are too small (items 7, 26 and 27
// of docs/stress.md).
#include <catch2/catch.hpp>
#include <cfenv>
#include <cmath>

#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::step_test {

using namespace skerry::test::stress;

TEST_CASE("a step_size above the stable step is not taken, and the report says for which body", "[scene][stress]") {
    for (const Real factor : {2.0, 10.0}) {
        const auto make = [](std::optional<Real> step_size) {
            Settings settings;
            settings.step_size = step_size;
            World world(settings);
            world.add_collider(Plane{});
            const auto soft = world.add_material({.young_modulus = 1e4}),
                       stiff = world.add_material({.young_modulus = 1e6});
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
                           {.material = soft, .position = {0, 0, 0.1}, .name = "soft"});
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
                           {.material = stiff, .position = {0.01, 0, 0.25}, .name = "stiff"});
            return world;
        };
        const Real stable = make({}).stable_step();
        World world = make(factor * stable);
        const Course course = follow(world, 0.3, 30);
        const std::string scene = "two boxes dropped, step_size " + text(factor) + " times the stable step, 0.3 s";
        judge({7, scene, "every step taken, finite", course.ok ? "all steps" : course.message,
               course.ok && course.finite});
        at_most(7, scene, "energy gained / in play", course.gain(), 1e-2);
        const StepReport report = world.advance(0.01);
        const std::string expected = report.limited_by;
        judge({7, scene, "every step shortened, the body named",
               text(course.limited) + " of " + text(course.steps) + ", '" + report.limited_by + "'",
               course.limited == course.steps && course.steps > 0 && report.limited_by == "stiff" &&
                   report.warning().find("'stiff'") != std::string::npos});
        at_most(7, scene, "step / stable step", report.step_size / world.stable_step(), 1);
        CHECK(world.report().limited == static_cast<std::uint64_t>(course.limited + report.limited));
    }
    World within;
    CHECK(within.advance(0.1).warning().empty());
}

TEST_CASE(
    "a body a thousand kilometres from the origin rests as it does there, one a million kilometres away is refused",
    "[scene][stress]") {
    const auto rest = [](Real distance) {
        World world;
        const auto material = world.add_material({.young_modulus = 1e5, .friction = 0.5, .damping = 20});
        const Vec3 place(distance, -0.7 * distance, 0.3 * distance);
        world.add_collider(Plane{.normal = {0, 0, 1}, .point = place});
        world.add_body(
            mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
            {.material = material, .position = place + Vec3(0, 0, 0.0512), .contact_distance = 2e-3, .name = "far"});
        return world;
    };
    World near = rest(0), far = rest(1e6);
    follow(near, 0.3, 10);
    const Course course = follow(far, 0.3, 10);
    const std::string scene = "box on a plane at 1e6 m, 0.3 s";
    judge(
        {26, scene, "every step taken, finite", course.ok ? "all steps" : course.message, course.ok && course.finite});
    Real apart = 0;
    const auto at = near.positions(near.bodies()[0]), there = far.positions(far.bodies()[0]);
    for (std::size_t n = 0; n < at.size(); ++n) apart = std::max(apart, (there[n] - there[0] - (at[n] - at[0])).norm());
    // Neighbouring numbers at 1e6 m are 1.2e-10 m apart, so the plane cannot hold the body better than that.
    at_most(26, scene, "shape apart from that at the origin, m", apart, 1e-8);
    at_most(26, scene, "penetration, m", course.max_penetration, 1e-6);

    World lost = rest(1e9);
    const StepReport report = lost.advance(0.01);
    judge({26, "box at 1e9 m", "refused; the message names the body and advises a local frame", report.message(),
           !report.ok() && report.status == StepStatus::too_far && report.steps == 0 &&
               report.message().find("'far'") != std::string::npos &&
               report.message().find("local frame") != std::string::npos});
    // A body that flies there is stopped on its way.
    Settings settings;
    settings.gravity = Vec3::Zero();
    World flight(settings);
    flight.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                    {.material = flight.add_material({.young_modulus = 1e3}), .velocity = {1e9, 0, 0}, .name = "fast"});
    const StepReport flown = flight.advance(2);
    judge({26, "box that flies off at 1e9 m/s", "taken until it is too far", flown.message(),
           flown.status == StepStatus::too_far && flown.steps > 0 && flight.time() > 0.1});
}

TEST_CASE("velocities that decay to nothing end at zero, not in denormal numbers", "[scene][stress]") {
    for (const Backend backend : {Backend::serial, Backend::automatic}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.backend = backend;
        settings.threads = backend == Backend::serial ? 0 : 2;
        World world(settings);
        const auto material = world.add_material({.young_modulus = 1e5, .damping = 10});
        const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {6, 6, 6});  // 1296 tetrahedra, enough to use the workers
        const auto body = world.add_body(mesh, {.material = material});
        std::vector<Vec3> tiny;
        for (const Vec3& x : mesh.nodes) tiny.push_back(1e-309 * x.normalized() + Vec3::Constant(3e-310));
        world.set_velocities(body, tiny);
        std::fesetround(FE_UPWARD);  // any rounding mode that the host may have set
        REQUIRE(world.advance(world.stable_step()).ok());
        volatile Real one = 1, little = 0x1p-60;
        const bool host_rounds_up = one + little > 1;
        volatile Real smallest = std::numeric_limits<Real>::min();
        const bool host_has_denormals = smallest / 2 > 0;
        std::fesetround(FE_TONEAREST);
        int denormal = 0;
        for (const Vec3& v : world.velocities(body))
            for (int k = 0; k < 3; ++k) denormal += std::fpclassify(v[k]) == FP_SUBNORMAL;
        const std::string scene = "velocities of 1e-309 m/s, " + std::string(name_of(world.settings().backend));
        at_most(27, scene, "denormal numbers after a step", denormal, 0);
        judge({27, scene, "the host's thread is left as it was", host_has_denormals && host_rounds_up ? "yes" : "no",
               host_has_denormals && host_rounds_up});
    }
}

}  // namespace skerry::test::step_test
