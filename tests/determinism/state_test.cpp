// The state contains everything that the next step depends on, and the hash covers each part of it. save_test.cpp tests
// that a world made from the state continues like the original.
#include <catch2/catch.hpp>
#include <cstring>
#include <type_traits>

#include "engine/world/state_hash.h"
#include "engine/world/step/step.h"
#include "tests/support/lively_scene.h"

namespace skerry::test::state_test {

TEST_CASE("bodies with clusters have the same bits on any number of workers", "[determinism][clusters]") {
    const auto thrown = [](Backend backend, int threads) {
        Settings settings;
        settings.backend = backend;
        settings.threads = threads;
        World world = thrown_slivers(settings);
        REQUIRE(world.advance(0.015).ok());
        return world;
    };
    const World world = thrown(available_backends().front(), 1);
    CHECK(world.report().clusters > 0);
    CHECK(world.report().contact_sum > 0);
    for (const Backend backend : available_backends())
        for (const int threads : {2, 4}) CHECK(thrown(backend, threads).state_hash() == world.state_hash());
}

TEST_CASE("the runs in the test of copies have bodies that sleep and wake", "[determinism][slow]") {
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

TEST_CASE("the hash sees a bit in every column that is state", "[determinism][serial]") {
    World world = lively_scene({});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = world.add_material({.young_modulus = 1e7}),
                                                           .position = {50, 0, 5},
                                                           .angular_velocity = {1, 2, 3},
                                                           .dynamics = BodyDynamics::implicit_elastic});
    REQUIRE(world.advance(0.21).ok());
    WorldState& state = WorldAccess::state_of(world);
    REQUIRE(state.cache.warm_start.key.size() > 0);
    REQUIRE(state.cache.pairs.size() > 0);
    for (PairState& known : state.cache.pairs.state)
        known = PairState::overlapping;  // pairs that are apart keep no state
    state.cache.resting.for_each_column([](const char*, auto& column, ColumnRole) { column.resize(1); });
    const std::uint64_t before = world.state_hash();
    int flipped = 0;
    const auto flip = [&](const char* name, auto& column, ColumnRole role) {
        if (!is_state(role) || column.empty()) return;
        CAPTURE(name);
        std::size_t row = 0;  // a row that refers to something, not no_index
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
    state.cache.resting.for_each_column(flip);
    state.cache.pairs.for_each_row_column(flip);
    CHECK(flipped > 50);
    state.model.watch.steps ^= 1;
    CHECK(world.state_hash() != before);
    state.model.watch.steps ^= 1;
    CHECK(world.state_hash() == before);
}

TEST_CASE("every column of a table that is state is tested for changes", "[determinism][serial]") {
    World world = lively_scene({});
    REQUIRE(world.advance(0.1).ok());
    WorldState& state = WorldAccess::state_of(world);
    const std::uint64_t before = world.state_hash();
    // Columns that are neither state nor link are not hashed, so they may hold any bytes.
    state.model.for_each_table([&](const char*, auto& columns) {
        columns.for_each_column([](const char*, auto& column, ColumnRole role) {
            if (is_state(role)) return;
            for (auto& row : column) std::memset(static_cast<void*>(&row), 0x5a, sizeof row);
        });
    });
    CHECK(world.state_hash() == before);
}

TEST_CASE("the hash of a body does not depend on other objects of the world", "[determinism]") {
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

}  // namespace skerry::test::state_test
