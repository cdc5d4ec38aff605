// Whole worlds give the same bits on any number of workers, on every backend, and in a second run.
#include <catch2/catch.hpp>

#include "engine/world/tuning.h"
#include "jobs/executor.h"
#include "tests/support/worlds.h"

namespace skerry::test::world_test {

namespace {

/// Balls that fall onto each other and a box. Contacts between bodies and with colliders form regions of many sizes.
/// The scene is large enough not to run inline.
World pile(Backend backend, int threads, MaterialModel model = MaterialModel::stable_neo_hookean) {
    Settings settings;
    settings.backend = backend;
    settings.threads = threads;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5, .damping = 4, .model = model});
    world.add_collider(Plane{});
    world.add_collider(Box{{0.2, 0.2, 0.04}});
    const Mesh ball = mesh::ball(0.05, 6);
    for (int i = 0; i < 9; ++i)
        world.add_body(ball, {.material = rubber,
                              .position = {0.07 * (i % 3) - 0.06, 0.06 * (i / 3 % 2), 0.08 + 0.1 * (i / 3)},
                              .velocity = {0.1 * i - 0.4, 0.05 * (i % 4), -1},
                              .angular_velocity = {1.0 * i, 2, -1}});
    return world;
}

std::uint64_t hash_after(Backend backend, int threads, MaterialModel model = MaterialModel::stable_neo_hookean) {
    World world = pile(backend, threads, model);
    const StepReport report = world.advance(0.07);
    REQUIRE(report.ok());
    REQUIRE(world.report().max_contacts > 40);
    REQUIRE(world.report().inline_steps == 0);
    return world.state_hash();
}

}  // namespace

TEST_CASE("a pile has the same bits for 1, 2, 3, 4 and 8 workers on every backend", "[determinism]") {
    const std::uint64_t expected = hash_after(Backend::serial, 1);
    for (Backend backend : available_backends())
        for (int threads : {1, 2, 3, 4, 8}) {
            INFO(name_of(backend) << " with " << threads);
            CHECK(hash_after(backend, threads) == expected);
            if (backend == Backend::serial) break;
        }
}

TEST_CASE("a pile of corotational balls has the same bits for 1 and 4 workers", "[determinism]") {
    const Backend backend = available_backends().front();
    CHECK(hash_after(backend, 1, MaterialModel::corotational) == hash_after(backend, 4, MaterialModel::corotational));
}

TEST_CASE("balls on a stiff implicit block have the same bits for 1 and 4 workers, in long steps of the block, too",
          "[determinism]") {
    for (const Real implicit_step : {0.0, 4e-3}) {
        std::vector<std::uint64_t> hashes;
        for (const int threads : {1, 4}) {
            Settings settings;
            settings.threads = threads;
            settings.implicit_step = implicit_step;
            World world(settings);
            const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5});
            const auto stiff = world.add_material({.young_modulus = 1e9, .friction = 0.5});
            world.add_collider(Plane{});
            world.add_body(mesh::box({0.4, 0.4, 0.1}, {6, 6, 2}),
                           {.material = stiff, .position = {0, 0, 0.052}, .dynamics = BodyDynamics::implicit_elastic});
            const Mesh ball = mesh::ball(0.05, 6);
            for (int i = 0; i < 4; ++i)
                world.add_body(ball, {.material = rubber,
                                      .position = {0.12 * (i % 2) - 0.06, 0.12 * (i / 2) - 0.06, 0.16},
                                      .velocity = {0.1 * i, 0, -1}});
            REQUIRE(world.advance(0.05).ok());
            REQUIRE(world.report().max_contacts > 20);
            REQUIRE(world.report().inline_steps == 0);
            hashes.push_back(world.state_hash());
        }
        CHECK(hashes[0] == hashes[1]);
    }
}

TEST_CASE("the hash sees a change of the last bit of one velocity", "[determinism][serial]") {
    World world = pile(Backend::serial, 1);
    const std::uint64_t before = world.state_hash();
    const BodyHandle body = world.bodies()[4];
    std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
    velocity[3].y() = std::nextafter(velocity[3].y(), 1e9);
    world.set_velocities(body, velocity);
    CHECK(world.state_hash() != before);
}

TEST_CASE("budgets that skip pairs that cannot be close change no bit that matters", "[determinism][serial]") {
    // Searching everything in every step finds the same contacts in the same order, so the runs stay equal.
    std::vector<std::uint64_t> hashes;
    for (bool budgets : {true, false}) {
        World world = tuned_world({.backend = Backend::serial}, {.contact_budgets = budgets});
        const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5});
        world.add_collider(Plane{});
        world.add_body(mesh::ball(0.05, 5), {.material = rubber, .position = {0, 0, 0.07}});
        world.add_body(mesh::ball(0.05, 5), {.material = rubber, .position = {0.02, 0, 0.18}});
        REQUIRE(world.advance(0.3).ok());
        REQUIRE(world.report().max_contacts > 5);
        hashes.push_back(world.state_hash());
    }
    CHECK(hashes[0] == hashes[1]);
}

}  // namespace skerry::test::world_test
