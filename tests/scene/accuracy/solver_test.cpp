// The way in which the solver divides and distributes its work does not change results (docs/accuracy.md, items 29 and
// 30).
#include <algorithm>
#include <catch2/catch.hpp>

#include "engine/world/tuning.h"
#include "tests/support/accuracy.h"
#include "tests/support/contact_scene.h"
#include "tests/support/worlds.h"

namespace skerry::test::accuracy_solver_test {

using accuracy::Tolerance;

namespace {

/// Balls that fall onto a block and onto each other. The scene is large enough not to run inline.
World pile(const Settings& settings, const Tuning& tuning = {}) {
    World world = tuned_world(settings, tuning);
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5, .damping = 4});
    world.add_collider(Plane{});
    world.add_body(mesh::box({0.2, 0.2, 0.06}, {4, 4, 1}), {.material = rubber, .position = {0, 0, 0.031}});
    const Mesh ball = mesh::ball(0.05, 5);
    for (int i = 0; i < 6; ++i)
        world.add_body(ball, {.material = rubber,
                              .position = {0.09 * (i % 3) - 0.08, 0.12 * (i / 3) - 0.06, 0.12 + 0.01 * i},
                              .velocity = {0.1 * i - 0.4, 0.05 * (i % 4), -1}});
    return world;
}

Real differing_numbers(const World& one, const World& other) {
    Real count = 0;
    for (std::size_t b = 0; b < one.bodies().size(); ++b) {
        const BodyHandle body = one.bodies()[b], twin = other.bodies()[b];
        for (std::size_t n = 0; n < one.positions(body).size(); ++n)
            for (int i = 0; i < 3; ++i) {
                count += one.positions(body)[n][i] != other.positions(twin)[n][i];
                count += one.velocities(body)[n][i] != other.velocities(twin)[n][i];
            }
    }
    return count + (one.state_hash() != other.state_hash());
}

/// Root mean square distance of the nodes of two worlds with the same bodies [m]
Real distance(const World& one, const World& other) {
    Real sum = 0, count = 0;
    for (std::size_t b = 0; b < one.bodies().size(); ++b) {
        const auto x = one.positions(one.bodies()[b]), y = other.positions(other.bodies()[b]);
        for (std::size_t n = 0; n < x.size(); ++n, ++count) sum += (x[n] - y[n]).squaredNorm();
    }
    return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("separate and global regions are bitwise equal with plain sweeps", "[scene][determinism][accuracy]") {
    std::vector<World> worlds;
    for (ContactRegions regions : {ContactRegions::separate, ContactRegions::global}) {
        Settings settings;
        settings.gravity = tilted_gravity(20);
        settings.contact_regions = regions;
        settings.method = SolverMethod::pgs;  // acceleration would couple the whole region
        settings.max_iterations = 10;
        worlds.push_back(pile(settings, {.fixed_iterations = true}));
        REQUIRE(worlds.back().advance(0.3).ok());
        REQUIRE(worlds.back().report().max_contacts > 40);
    }
    REQUIRE(worlds[0].report().max_regions > 5);
    REQUIRE(worlds[1].report().max_regions == 1);
    accuracy::check({.item = 29,
                     .name = "separate and global, plain sweeps: numbers of the state that differ",
                     .formula = "0",
                     .found = differing_numbers(worlds[0], worlds[1]),
                     .tolerance = 0,
                     .kind = Tolerance::absolute});
}

TEST_CASE("separate and global regions agree to the tolerance with acceleration", "[scene][accuracy]") {
    // Only one solve: over many steps a difference of rounding size would grow like any other.
    constexpr Real tolerance = 1e-8;
    ContactScene scene;
    for (int sheet = 0; sheet < 12; ++sheet) add_sheets(scene, 3 + sheet % 5, 0.5, static_cast<unsigned>(sheet));
    Real speed = 0, worst = 0;
    for (const Vec3& v : scene.velocity) speed = std::max(speed, v.norm());
    const SolverSettings settings{.method = SolverMethod::ags, .tolerance = tolerance, .max_iterations = 20000};
    const SolvedScene separate = scene.solve(settings), global = scene.solve(settings, ContactRegions::global);
    REQUIRE(separate.regions.size() == 12);
    REQUIRE(global.regions.size() == 1);
    for (std::size_t n = 0; n < scene.velocity.size(); ++n)
        worst = std::max(worst, (separate.velocity[n] - global.velocity[n]).norm() / speed);
    accuracy::check({.item = 29,
                     .name = "separate and global, accelerated sweeps: difference of velocities over speed",
                     .formula = "0, tolerance 10 times that of the solver",
                     .found = worst,
                     .tolerance = 10 * tolerance,
                     .kind = Tolerance::absolute});
}

TEST_CASE("1 to 64 threads give the same bits after 1000 steps", "[scene][determinism][accuracy]") {
    Settings settings;
    settings.threads = 1;
    constexpr Real h = 3e-4;  // a third of the stable step
    settings.step_size = h;
    World expected = pile(settings);
    REQUIRE(expected.advance(1000 * h).steps == 1000);
    REQUIRE(expected.report().inline_steps == 0);
    Real differing = 0;
    for (int threads : {2, 4, 8, 16, 32, 64}) {
        settings.threads = threads;
        World world = pile(settings);
        REQUIRE(world.advance(1000 * h).ok());
        differing += differing_numbers(expected, world);
    }
    accuracy::check({.item = 30,
                     .name = "1, 2, 4, 8, 16, 32, 64 threads, 1000 steps: numbers of the state that differ",
                     .formula = "0",
                     .found = differing,
                     .tolerance = 0,
                     .kind = Tolerance::absolute});
}

TEST_CASE("errors of the solver do not add up as steps get shorter", "[scene][accuracy]") {
    constexpr Real length = 0.1, shell = 0.001;
    for (const Real step : {4e-4, 1e-5}) {
        CAPTURE(step);
        std::vector<World> worlds;
        for (const Real tolerance : {Settings{}.tolerance, 1e-8}) {
            Settings settings = accurate({0, 0, -standard_gravity}, tolerance);
            settings.step_size = step;
            World& world = worlds.emplace_back(settings);
            const auto rubber = world.add_material({.young_modulus = 1e5, .density = 1000, .friction = 0.5});
            world.add_collider(Plane{});
            world.add_body(mesh::box({0.16, 0.1, 0.05}, {6, 4, 2}),
                           {.material = rubber, .position = {0, 0, 0.025 + shell / 2}, .contact_distance = shell});
            world.add_body(mesh::box({length, 0.08, 0.05}, {4, 4, 2}), {.material = rubber,
                                                                        .position = {0.02, 0.01, 0.075 + 1.5 * shell},
                                                                        .velocity = {0.3, 0.1, 0},
                                                                        .contact_distance = shell});
            REQUIRE(world.advance(0.1).ok());
        }
        // With errors relative to all motion, including sliding and gaps within reach, it would be 5e-5 and 2e-3.
        CHECK(distance(worlds[0], worlds[1]) < 1e-5 * length);
    }
}

}  // namespace skerry::test::accuracy_solver_test
