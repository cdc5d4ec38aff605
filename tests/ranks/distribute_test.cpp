// Bodies of a divided world: their owners, and their moves between ranks.
#include <catch2/catch.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "engine/world/ranks/hold/ghosts.h"
#include "skerry/ranks.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/message_of.h"

namespace skerry::test {
namespace {
namespace distribute_test {

RankScene own_scene(const std::string& name) {
    return scene_of_file("tests/ranks/scenes/" + name + ".json");
}

/// Divides the world of a scene, moves bodies to random owners several times, and gathers them on rank 0.
std::uint64_t hash_of_gathered(const RankScene& scene, Real seconds, int count, OwnerMap map) {
    std::uint64_t hash = 0;
    run_on_ranks(count, [&](Ranks& ranks) {
        World world = scene.make(1);
        world.advance(seconds);
        distribute(world, ranks, {.map = map, .seed = 7});
        WorldState& state = WorldAccess::state_of(world);
        for (std::int32_t turn = 0; turn < 3; ++turn) {
            Column<std::int32_t> owner = state.ranks.whole.owner;
            for (std::size_t place = 0; place < owner.size(); ++place)
                if (owner[place] != WholeWorld::everywhere)
                    owner[place] = (state.ranks.whole.unit[place] + turn) % ranks.size();
            move_to_owners(state, owner);
        }
        std::optional<World> whole = gathered(world);
        CHECK(whole.has_value() == (ranks.rank() == 0));
        if (whole) hash = whole->state_hash();
    });
    return hash;
}

TEST_CASE("a world that was divided, whose bodies changed owners and that was gathered, is unchanged", "[ranks]") {
    for (const char* name : {"pile", "sleep", "stiff", "linked", "surfaces", "one_region"}) {
        const RankScene scene = own_scene(name);
        const Real seconds = scene.seconds / 4;
        World whole = scene.make(1);
        whole.advance(seconds);
        INFO(name);
        CHECK(hash_of_gathered(scene, seconds, 3, OwnerMap::curve) == whole.state_hash());
        CHECK(hash_of_gathered(scene, seconds, 2, OwnerMap::random) == whole.state_hash());
    }
}

TEST_CASE("each rank of a pile holds only a part of the bodies", "[ranks]") {
    const RankScene scene = own_scene("pile");
    std::vector<std::size_t> held(4), owned(4);
    std::size_t all = 0;
    run_on_ranks(4, [&](Ranks& ranks) {
        World world = scene.make(1);
        if (ranks.rank() == 0) all = world.bodies().size();
        distribute(world, ranks);
        const RankState& state = WorldAccess::state_of(world).ranks;
        held[static_cast<std::size_t>(ranks.rank())] = state.place.size();
        for (std::size_t b = 0; b < state.place.size(); ++b)
            owned[static_cast<std::size_t>(ranks.rank())] += state.owns(b);
    });
    CHECK(std::accumulate(owned.begin(), owned.end(), std::size_t{0}) == all);
    for (const std::size_t of_rank : owned) CHECK(of_rank > 0);
    CHECK(std::ranges::min(held) < all);
}

TEST_CASE("a scene has the same bits on ranks that hold only some bodies as without ranks", "[.][subsets]") {
    for (const char* name : {"pile", "shots", "sleep", "stiff", "linked", "surfaces", "refused", "one_region"}) {
        const RankScene scene = own_scene(name);
        const WholeRun whole = run_whole(scene);
        for (const OwnerMap map : {OwnerMap::curve, OwnerMap::round_robin, OwnerMap::random})
            for (const int count : {2, 3, 4, 8}) {
                const auto divide = [&](World& world, Ranks& ranks) { distribute(world, ranks, {.map = map}); };
                INFO(name << " " << count << " " << static_cast<int>(map));
                CHECK(run_on_ranks_differs(scene, whole, count, 1, divide) == "");
            }
    }
}

TEST_CASE("a divided world refuses to be changed or divided again", "[ranks]") {
    const RankScene scene = own_scene("pile");
    run_on_ranks(2, [&](Ranks& ranks) {
        World world = scene.make(1);
        distribute(world, ranks);
        CHECK(message_of([&] { world.remove(world.bodies()[0]); }).find("a world that is divided among ranks") !=
              std::string::npos);
        CHECK(message_of([&] { distribute(world, ranks); }).find("already divided") != std::string::npos);
    });
}

}  // namespace distribute_test
}  // namespace
}  // namespace skerry::test
