// Worlds that are split into two worlds and put together again.
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "engine/world/ranks/rows/body_rows.h"
#include "tests/support/lively_scene.h"

namespace skerry::test {
namespace {
namespace body_rows_test {

void start(WorldState& world) {
    world.ranks.whole = whole_world_of(world.model);
    for (std::size_t b = 0; b < world.model.bodies.slot.size(); ++b)
        world.ranks.world_row.push_back(static_cast<Index>(b));
}

/// Moves random units of a world to a message, and back from it.
void split_and_merge(World& of, std::uint64_t seed) {
    WorldState& world = WorldAccess::state_of(of);
    start(world);
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> leaves, stays;
    for (std::size_t b = 0; b < world.ranks.world_row.size(); ++b) {
        const auto unit = static_cast<std::size_t>(world.ranks.whole.unit[b]);
        const bool moves = world.model.bodies.kind[b] == BodyKind::deformable;
        leaves.push_back(unit < b ? leaves[unit] : moves && random() % 2 == 0);
        stays.push_back(leaves.back() == 0);
    }
    const auto leaving = [&](std::uint64_t pair) {
        const PairSlots slots = slots_of_pair(pair);
        return leaves[static_cast<std::size_t>(world.ranks.whole.row_of_slot(slots.first))] != 0 ||
               (!slots.is_collider &&
                leaves[static_cast<std::size_t>(world.ranks.whole.row_of_slot(slots.second))] != 0);
    };
    BodyRows gone = rows_of_bodies(world, leaves, leaving);
    const RankMessage message = message_of(gone);
    replace_rows(world, stays, {}, [&](std::uint64_t pair) { return !leaving(pair); });
    BodyRows back = rows_of_message(message);
    const std::vector<std::uint8_t> all(world.ranks.world_row.size(), 1);
    replace_rows(world, all, {&back, 1}, [](std::uint64_t) { return true; });
    world.ranks = {};
}

void check_split(const std::function<World()>& make, Real before, Real after) {
    World whole = make();
    REQUIRE(whole.advance(before).ok());
    World split = whole.clone();
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        split_and_merge(split, seed);
        REQUIRE(split.state_hash() == whole.state_hash());
    }
    REQUIRE(whole.advance(after).ok());
    REQUIRE(split.advance(after).ok());
    CHECK(split.state_hash() == whole.state_hash());
    CHECK(split.report().steps == whole.report().steps);
}

TEST_CASE("a world whose bodies were moved out and back has the same state, and computes the same steps") {
    check_split([] { return lively_scene({}); }, 0.05, 0.05);
}

TEST_CASE("bodies with clusters are moved with their matrices") {
    check_split([] { return thrown_slivers(); }, 0.03, 0.005);
}

}  // namespace body_rows_test
}  // namespace
}  // namespace skerry::test
