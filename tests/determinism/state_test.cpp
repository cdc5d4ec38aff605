// What is state is all that the next step depends on: a copy of it goes on as the original does, and the hash sees each
// part of it.
#include <catch2/catch.hpp>
#include <cstring>
#include <type_traits>

#include "engine/world/copy_state.h"
#include "engine/world/state_hash.h"
#include "engine/world/step/step.h"
#include "tests/support/sliver_box.h"
#include "tests/support/worlds.h"

using namespace skerry;
using namespace skerry::test;

namespace {

/// Everything that has a memory at once: stiff and soft elements with levels, also in one body, bodies at rest and
/// bodies that fall onto them, friction, damping, loads, a mesh collider and a bar that move by scripts, and a held
/// body.
World lively_scene(Settings settings, int threads = 1) {
    settings.backend = available_backends().front();
    settings.threads = threads;
    settings.multirate = true;
    settings.sleep_speed = 0.2;
    settings.sleep_time = 0.02;
    settings.start_overlaps = StartOverlaps::ignore;  // some begin in each other, and are a pair that overlaps
    World world(settings);
    const auto soft = world.add_material(
        {.young_modulus = 2e4, .friction = 0.5, .damping = 30, .loss_factor = 0.2, .bulk_viscosity = 0.06});
    const auto stiff = world.add_material({.young_modulus = 4e5,
                                           .friction = 0.3,
                                           .damping = 2,
                                           .loss_factor = 0.05,
                                           .model = MaterialModel::corotational});
    world.add_collider(Plane{});
    Mesh paddle = mesh::box({0.3, 0.05, 0.02}, {3, 1, 1});
    world.add_collider(Capsule{0.02, 0.2}, {.position = {-0.25, 0, 0.05},
                                            .motion = {.keys = {{0, {-0.25, 0, 0.05}, {0, 0, 0}},
                                                                {0.5, {0.05, 0, 0.08}, {0, 0.5, 0}},
                                                                {2, {0.1, 0, 0.08}, {0, 1.5, 0}}}}});
    SurfaceMesh lid;
    lid.nodes = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    lid.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    world.add_collider(lid, {.position = {0.3, 0, 0.01}, .motion = {.velocity = {-0.05, 0, 0}}});
    const Mesh ball = mesh::ball(0.05, 5);
    for (int i = 0; i < 6; ++i)
        world.add_body(ball, {.material = i % 3 == 0 ? stiff : soft,
                              .position = {0.104 * (i % 3) - 0.1, 0.01 * i, 0.052 + 0.2 * (i / 3)},
                              .rotation = {0.3 * i, 0.2, 0.1 * i},
                              .velocity = {0, 0, i < 3 ? 0.0 : -0.5}});
    for (std::size_t e = 0; e < paddle.tetrahedra.size(); ++e) paddle.label.push_back(e % 5 == 0 ? 1 : 0);
    const auto held = world.add_body(paddle, {.material = soft, .materials = {{1, stiff}}, .position = {0, 0.3, 0.3}});
    world.attach(held, std::vector<Index>{0, 1, 2, 3}, {.velocity = {0, 0, 0.01}}, {0, 0.3, 0.3});
    world.set_loads(held, std::vector<Vec3>(world.positions(held).size(), Vec3(0, 1e-3, 0)));
    return world;
}

void check_same_bits(const World& a, const World& b) {
    const std::vector<BodyHandle> bodies = a.bodies();
    REQUIRE(b.bodies() == bodies);
    for (BodyHandle body : bodies) {
        const auto x = a.positions(body), y = b.positions(body), u = a.velocities(body), v = b.velocities(body);
        REQUIRE(x.size() == y.size());
        CHECK(std::memcmp(x.data(), y.data(), x.size_bytes()) == 0);
        CHECK(std::memcmp(u.data(), v.data(), u.size_bytes()) == 0);
    }
}

/// Runs in calls of odd lengths until so many steps were taken.
void take_steps(World& world, std::uint64_t steps) {
    const std::uint64_t end = world.report().steps + steps;
    while (world.report().steps < end) REQUIRE(world.advance(world.stable_step() * 7.3).ok());
}

}  // namespace

TEST_CASE("bodies with clusters have the same bits on any number of workers, and their copies go on with them",
          "[determinism][clusters]") {
    const auto thrown = [](Backend backend, int threads) {
        Settings settings;
        settings.backend = backend;
        settings.threads = threads;
        World world(settings);
        world.add_collider(Plane{});
        const auto soft = world.add_material({.young_modulus = 2e4, .friction = 0.5});
        for (int i = 0; i < 3; ++i)
            world.add_body(sliver_box(0.1, 6, 0.01, 0.005, 1 + static_cast<std::uint64_t>(i)),
                           {.material = soft, .position = {0.02 * i, 0, 0.06 + 0.11 * i}, .velocity = {0, 0, -3}});
        return world;
    };
    World world = thrown(available_backends().front(), 1);
    REQUIRE(world.advance(0.015).ok());
    CHECK(world.report().clusters > 0);
    CHECK(world.report().contact_sum > 0);
    for (const Backend backend : available_backends())
        for (const int threads : {2, 4}) {
            World other = thrown(backend, threads);
            REQUIRE(other.advance(0.015).ok());
            CHECK(other.state_hash() == world.state_hash());
        }
    World copy = thrown(available_backends().front(), 2);
    copy_state(WorldAccess::state_of(world), WorldAccess::state_of(copy));
    CHECK(copy.state_hash() == world.state_hash());
    REQUIRE(world.advance(0.015).ok());
    REQUIRE(copy.advance(0.015).ok());
    check_same_bits(world, copy);
    CHECK(copy.state_hash() == world.state_hash());
}

TEST_CASE("a copy of the state goes on for a thousand steps with the same bits", "[determinism][slow]") {
    // where sleep, warm start, multirate and lists of any age are at work
    for (const Integrator integrator : {Integrator::leapfrog, Integrator::symplectic_euler})
        for (const double seconds : {0.05, 0.21, 0.4}) {
            CAPTURE(name_of(integrator), seconds);
            Settings settings;
            settings.integrator = integrator;
            World world = lively_scene(settings);
            REQUIRE(world.advance(seconds).ok());
            World copy = lively_scene(settings, 2);  // its own past does not matter
            copy.remove(copy.bodies().front());
            copy_state(WorldAccess::state_of(world), WorldAccess::state_of(copy));
            CHECK(copy.state_hash() == world.state_hash());
            CHECK(copy.time() == world.time());
            for (int part = 0; part < 4; ++part) {
                take_steps(world, 250);
                take_steps(copy, 250);
                CHECK(copy.state_hash() == world.state_hash());
            }
            check_same_bits(world, copy);
            const WorldReport report = world.report();
            CHECK(report.max_contacts > 20);
            CHECK(report.level_elements.size() > 1);
        }
}

TEST_CASE("what the test of copies runs has bodies that sleep and wake", "[determinism][slow]") {
    World world = lively_scene({});
    std::size_t most = 0;
    bool woken = false;
    for (int frame = 0; frame < 60; ++frame) {
        REQUIRE(world.advance(0.01).ok());
        const std::size_t asleep = world.report().asleep;
        woken |= asleep < most;
        most = std::max(most, asleep);
    }
    CHECK(most > 0);
    CHECK(woken);
}

TEST_CASE("the hash sees a bit in every column that is state", "[determinism]") {
    World world = lively_scene({});
    REQUIRE(world.advance(0.21).ok());
    WorldState& state = WorldAccess::state_of(world);
    REQUIRE(state.cache.warm_start.key.size() > 0);
    REQUIRE(state.cache.pairs.size() > 0);
    state.clock.cycle.index = 1;  // between cycles the levels of bodies mean nothing
    for (PairState& known : state.cache.pairs.state)
        known = PairState::overlapping;  // of what is apart nothing is kept
    const std::uint64_t before = world.state_hash();
    int flipped = 0;
    const auto flip = [&](const char* name, auto& column, ColumnRole role) {
        if (!is_state(role) || column.empty()) return;
        CAPTURE(name);
        std::size_t row = 0;  // one that names something, not no_index
        if constexpr (std::is_same_v<std::decay_t<decltype(column[0])>, Index>)
            while (row + 1 < column.size() && column[row] == no_index) ++row;
        auto& byte = *reinterpret_cast<unsigned char*>(&column[row]);
        byte ^= 1;
        CHECK(world.state_hash() != before);
        byte ^= 1;
        ++flipped;
    };
    state.model.for_each_table([&](const char* table, auto& columns) {
        CAPTURE(table);
        columns.for_each_column(flip);
    });
    state.cache.warm_start.for_each_column(flip);
    state.cache.pairs.for_each_row_column(flip);
    CHECK(flipped > 50);
    state.clock.steps_since_watch ^= 1;
    CHECK(world.state_hash() != before);
    state.clock.steps_since_watch ^= 1;
    CHECK(world.state_hash() == before);
}

TEST_CASE("every column of a table that is state can be told from what is not", "[determinism]") {
    World world = lively_scene({});
    REQUIRE(world.advance(0.1).ok());
    WorldState& state = WorldAccess::state_of(world);
    const std::uint64_t before = world.state_hash();
    // What is neither state nor link is none of the hash's business: it may hold anything.
    state.model.for_each_table([&](const char*, auto& columns) {
        columns.for_each_column([](const char*, auto& column, ColumnRole role) {
            if (is_state(role)) return;
            for (auto& row : column) std::memset(static_cast<void*>(&row), 0x5a, sizeof row);
        });
    });
    CHECK(world.state_hash() == before);
}

TEST_CASE("the hash of a body does not depend on what else is in the world", "[determinism]") {
    const auto body_of = [](bool with_others) {
        World world;
        const auto rubber = world.add_material({.young_modulus = 3e4});
        const BodyHandle first = world.add_body(mesh::ball(0.1, with_others ? 5 : 3), {.material = rubber});
        const BodyHandle second =
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = rubber, .position = {0, 0, 1}});
        world.attach(second, std::vector<Index>{0}, {});
        if (!with_others) world.remove(first);
        WorldState& state = WorldAccess::state_of(world);
        return body_hash(state.model, static_cast<std::size_t>(state.model.body_map.row(second)));
    };
    CHECK(body_of(true) == body_of(false));
}

TEST_CASE("worlds with the same bodies have the same hash, whoever was there before", "[determinism]") {
    const auto hash_after = [](int resolution) {
        World world;
        const auto rubber = world.add_material({.young_modulus = 3e4});
        const BodyHandle gone =
            world.add_body(mesh::ball(0.1, resolution), {.material = rubber, .position = {5, 0, 1}});
        world.add_collider(Plane{});
        for (int i = 0; i < 3; ++i)
            world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0.09 * i, 0, 0.06}});
        world.remove(gone);
        REQUIRE(world.advance(0.1).ok());
        REQUIRE(world.contacts().size() > 0);
        return world.state_hash();
    };
    CHECK(hash_after(3) == hash_after(6));
}
