// Bodies of a divided world: their owners, and their moves between ranks.
#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/world/ranks/hold/ghosts.h"
#include "skerry/ranks.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/count_allocations.h"
#include "tests/support/draws.h"
#include "tests/support/message_of.h"

namespace skerry::test {
namespace {
namespace distribute_test {

RankScene own_scene(const std::string& name) {
    return scene_of_file("tests/ranks/scenes/" + name + ".json");
}

/// Other owners of all units. `turn`: number of the change.
Column<std::int32_t> next_owners(const RankState& ranks, std::int32_t turn) {
    Column<std::int32_t> owner = ranks.whole.owner;
    for (std::size_t world_row = 0; world_row < owner.size(); ++world_row)
        if (owner[world_row] != WholeWorld::everywhere)
            owner[world_row] = (ranks.whole.unit[world_row] + turn) % ranks.ranks->size();
    return owner;
}

/// Divides the world of a scene, moves bodies to other owners several times, and gathers them on rank 0.
std::uint64_t hash_of_gathered(const RankScene& scene, Real seconds, int count, OwnerMap map) {
    std::uint64_t hash = 0;
    run_on_ranks(count, [&](Ranks& ranks) {
        World world = scene.make(1);
        world.advance(seconds);
        distribute(world, ranks, {.map = map, .seed = 7});
        WorldState& state = WorldAccess::state_of(world);
        for (std::int32_t turn = 0; turn < 3; ++turn) move_to_owners(state, next_owners(state.ranks, turn));
        std::optional<World> whole = gathered(world);
        if (whole) hash = whole->state_hash();
    });
    return hash;
}

TEST_CASE("a world that was divided, whose bodies changed owners and that was gathered, is unchanged", "[ranks]") {
    int turn = 0;
    for (const char* name : {"pile", "sleep", "stiff", "linked", "surfaces"}) {
        const RankScene scene = own_scene(name);
        const Real seconds = scene.seconds / 10;
        World whole = scene.make(1);
        whole.advance(seconds);
        INFO(name);
        const OwnerMap map = turn++ % 2 == 0 ? OwnerMap::curve : OwnerMap::random;
        CHECK(hash_of_gathered(scene, seconds, 3, map) == whole.state_hash());
    }
}

/// Impulses of the contacts of the last step.
std::vector<Vec3> impulses_of(const World& world) {
    std::vector<Vec3> impulses;
    for (const Contact& contact : world.contacts()) impulses.push_back(contact.impulse);
    return impulses;
}

TEST_CASE("bodies that get new owners while they touch move as without ranks", "[ranks]") {
    constexpr int calls = 6;
    for (const char* name : {"pile", "shots", "linked", "frames"}) {
        const RankScene scene = own_scene(name);
        const Real seconds = scene.seconds / (3 * calls);
        World whole = scene.make(1);
        for (int call = 0; call < calls; ++call) whole.advance(seconds);
        std::uint64_t hash = 0;
        std::vector<Vec3> impulses;
        run_on_ranks(3, [&](Ranks& ranks) {
            World world = scene.make(1);
            distribute(world, ranks);
            WorldState& state = WorldAccess::state_of(world);
            for (std::int32_t call = 0; call < calls; ++call) {
                world.advance(seconds);
                if (call + 1 < calls) move_to_owners(state, next_owners(state.ranks, call));
            }
            if (std::optional<World> all = gathered(world)) {
                hash = all->state_hash();
                impulses = impulses_of(*all);
            }
        });
        INFO(name);
        CHECK(hash == whole.state_hash());
        CHECK(impulses == impulses_of(whole));
    }
}

/// Runs a scene without ranks and then on ranks, and checks that the state of both is equal at the end. Returns the
/// worlds.
std::vector<World> run_both(const RankScene& scene, int count, int calls) {
    std::vector<World> both;
    both.push_back(scene.make(1));
    for (int call = 0; call < calls; ++call) both[0].advance(scene.seconds / calls);
    std::optional<World> whole;
    run_on_ranks(count, [&](Ranks& ranks) {
        World world = scene.make(1);
        distribute(world, ranks);
        WorldState& state = WorldAccess::state_of(world);
        for (std::int32_t call = 0; call < calls; ++call) {
            world.advance(scene.seconds / calls);
            if (call + 1 < calls) move_to_owners(state, next_owners(state.ranks, call));
        }
        if (std::optional<World> all = gathered(world)) whole.emplace(std::move(*all));
    });
    both.push_back(std::move(*whole));
    INFO(scene.name);
    CHECK(both[0].state_hash() == both[1].state_hash());
    return both;
}

TEST_CASE("a body that a contact throws at a body of another rank within a step meets it", "[ranks]") {
    const std::vector<World> both = run_both(own_scene("thrown"), 3, 1);
    CHECK(both[0].report().contact_sum == both[1].report().contact_sum);
}

TEST_CASE("bodies whose tie breaks collide on every rank that gets them later", "[ranks]") {
    std::vector<World> both = run_both(own_scene("released"), 2, 4);
    for (World& world : both) world.advance(0.02);
    CHECK(both[0].state_hash() == both[1].state_hash());
    CHECK(both[0].report().contact_sum == both[1].report().contact_sum);
}

TEST_CASE("bodies move between ranks with and without rigid bodies", "[ranks]") {
    run_both(own_scene("apart"), 2, 4);
}

TEST_CASE("a gathered world reports the stable step of the undivided world", "[ranks]") {
    RankScene scene = own_scene("linked");
    scene.seconds /= 10;
    const std::vector<World> both = run_both(scene, 2, 1);
    CHECK(both[0].report().stable_step == both[1].report().stable_step);
}

TEST_CASE("implicit bodies with long steps get new owners within a long step", "[ranks]") {
    const RankScene scene = own_scene("long_steps");
    const auto divide = [](World& world, Ranks& ranks) { distribute(world, ranks); };
    CHECK(run_on_ranks_differs(scene, run_whole(scene), 3, 1, divide) == "");
}

TEST_CASE("bodies of all ranks that cross themselves are reported", "[ranks]") {
    const std::vector<World> both = run_both(own_scene("folded"), 2, 2);
    const auto messages = [](const World& world) {
        std::vector<std::string> all;
        for (const SelfCrossing& found : world.report().self_crossings) all.push_back(found.message());
        return all;
    };
    REQUIRE(messages(both[0]).size() > 0);
    CHECK(messages(both[0]) == messages(both[1]));
}

TEST_CASE("only rank 0 needs to build the world", "[ranks]") {
    for (const char* name : {"pile", "linked", "frames"}) {
        const RankScene scene = own_scene(name);
        World whole = scene.make(1);
        whole.advance(scene.seconds / 4);
        std::uint64_t hash = 0;
        run_on_ranks(3, [&](Ranks& ranks) {
            World world = ranks.rank() == 0 ? scene.make(1) : World({.threads = 1});
            distribute(world, ranks);
            world.advance(scene.seconds / 4);
            if (const std::optional<World> all = gathered(world)) hash = all->state_hash();
        });
        INFO(name);
        CHECK(hash == whole.state_hash());
    }
}

TEST_CASE("a world that cannot be divided is refused on all ranks", "[ranks]") {
    std::mutex mutex;
    std::vector<std::string> messages;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world({.contact_regions = ranks.rank() == 0 ? ContactRegions::global : ContactRegions::separate});
        const std::string message = message_of([&] { distribute(world, ranks); });
        const std::scoped_lock lock(mutex);
        messages.push_back(message);
    });
    CHECK(messages[0].find("settings.contact_regions: found global") != std::string::npos);
    CHECK(messages == std::vector<std::string>(3, messages[0]));
}

/// Bodies with sets and labels, some of which are far apart.
World bodies_with_sets() {
    World world({.gravity = Vec3::Zero(), .threads = 1});
    const MaterialHandle rubber = world.add_material({});
    for (int i = 0; i < 9; ++i) {
        Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1 + i % 2, 1, 1});
        mesh.label.assign(mesh.tetrahedra.size(), i);
        mesh.sets["end"].nodes = {0, 1 + i % 3};
        world.add_body(mesh, {.material = rubber, .position = {0.3 * i, 0, 0}});
    }
    return world;
}

TEST_CASE("bodies keep their meshes, labels and sets on the ranks to which they move", "[ranks]") {
    World whole = bodies_with_sets();
    const Model& expected = WorldAccess::state_of(whole).model;
    std::atomic<int> compared = 0;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = ranks.rank() == 0 ? bodies_with_sets() : World({.threads = 1});
        distribute(world, ranks);
        WorldState& state = WorldAccess::state_of(world);
        for (std::int32_t turn = 0; turn < 3; ++turn) {
            move_to_owners(state, next_owners(state.ranks, turn));
            for (std::size_t b = 0; b < state.ranks.world_row.size(); ++b) {
                const BodyRecord& found = state.model.body_records[b];
                const BodyRecord& record = expected.body_records[static_cast<std::size_t>(state.ranks.world_row[b])];
                const auto require_same = [&](bool same, const char* member) {
                    if (!same) throw std::runtime_error("body '" + record.name + "' has another " + member);
                };
                require_same(found.name == record.name, "name");
                require_same(found.tetrahedra == record.tetrahedra, "list of tetrahedra");
                require_same(found.surface == record.surface, "surface");
                require_same(found.label == record.label, "list of labels");
                require_same(found.sets == record.sets, "list of sets");
                ++compared;
            }
        }
    });
    CHECK(compared >= 3 * 9);
}

/// A run in which an allocation of rank 1 fails.
struct FailedAllocation {
    bool happened = false;  // false: rank 1 needs fewer allocations
    std::string error;      // the error that ends the job
};

/// Calls act() on both ranks of a divided world. The allocation of this number fails on rank 1.
FailedAllocation fail_allocation(long number, const RankScene& scene, const std::function<void(World&)>& act) {
    FailedAllocation failed;
    try {
        run_on_ranks(2, [&](Ranks& ranks) {
            World world = scene.make(1);
            distribute(world, ranks);
            const bool fails = ranks.rank() == 1;
            if (fails) allocations_until_failure = number;
            act(world);
            if (fails) failed.happened = std::exchange(allocations_until_failure, -1) < 0;
        });
    } catch (const std::exception& error) {
        return {true, error.what()};
    }
    return failed;
}

TEST_CASE("a rank that runs out of memory ends the job, before its world can be seen", "[ranks]") {
    const RankScene scene = own_scene("thrown");
    const std::function<void(World&)> acts[] = {[&](World& world) { world.advance(scene.seconds / 4); },
                                                [](World& world) { gathered(world); }};
    for (const std::function<void(World&)>& act : acts) {
        int ended = 0;
        for (long number = 0;; number += 1 + number / 8) {
            const FailedAllocation failed = fail_allocation(number, scene, act);
            if (!failed.happened) break;
            if (failed.error.empty()) continue;  // std::stable_sort manages without this memory
            INFO(number);
            CHECK(failed.error ==
                  "rank 1 ends with code 1: found too little memory, expected enough for the bodies of this rank (use "
                  "more machines)");
            ++ended;
        }
        CHECK(ended > 10);
    }
}

/// Two boxes that fly towards each other and collide after 0.095 s.
World approaching_boxes() {
    World world({.gravity = Vec3::Zero()});
    const MaterialHandle rubber = world.add_material({});
    for (const Real side : {-1.0, 1.0})
        world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                       {.material = rubber, .position = {side, 0, 0}, .velocity = {-10 * side, 0, 0}});
    return world;
}

TEST_CASE("bodies of two ranks that come from afar collide as without ranks", "[ranks]") {
    constexpr Real before = 0.02, after = 0.1;
    World whole = approaching_boxes();
    whole.advance(before);
    whole.advance(after);
    REQUIRE(whole.report().contact_sum > 0);
    std::uint64_t hash = 0;
    std::size_t held_before = 0, held_after = 0;
    run_on_ranks(2, [&](Ranks& ranks) {
        World world = approaching_boxes();
        distribute(world, ranks);
        world.advance(before);
        const std::size_t first = world.bodies().size();
        world.advance(after);
        const std::size_t second = world.bodies().size();
        if (std::optional<World> all = gathered(world)) {
            hash = all->state_hash();
            held_before = first;
            held_after = second;
        }
    });
    CHECK(held_before == 1);
    CHECK(held_after == 2);
    CHECK(hash == whole.state_hash());
}

TEST_CASE("each rank of a row of bodies holds only its neighbours", "[ranks]") {
    constexpr std::size_t bodies = 12;
    std::vector<std::size_t> held(4), owned(4), peers(4);
    run_on_ranks(4, [&](Ranks& ranks) {
        World world({.gravity = Vec3::Zero()});
        const MaterialHandle rubber = world.add_material({});
        for (std::size_t i = 0; i < bodies; ++i)
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                           {.material = rubber, .position = {0.2 * static_cast<Real>(i), 0, 0}});
        distribute(world, ranks);
        const RankState& state = WorldAccess::state_of(world).ranks;
        const auto rank = static_cast<std::size_t>(ranks.rank());
        held[rank] = state.world_row.size();
        for (std::size_t b = 0; b < state.world_row.size(); ++b) owned[rank] += state.owns(b);
        peers[rank] = state.peers.size();
    });
    CHECK(owned == std::vector<std::size_t>(4, bodies / 4));
    CHECK(held == std::vector<std::size_t>{4, 5, 5, 4});
    CHECK(peers == std::vector<std::size_t>{1, 2, 2, 1});
}

TEST_CASE("a scene has the same bits on ranks that hold only some bodies as without ranks", "[ranks]") {
    const std::vector<std::string> all{"pile",  "shots",    "linked",  "sleep",
                                       "stiff", "surfaces", "refused", "one_region"};
    for (std::size_t turn = 0; turn < (full_tests() ? all.size() : 2); ++turn) {
        const RankScene scene = own_scene(all[turn]);
        const WholeRun whole = run_whole(scene);
        int number = 0;
        for (const OwnerMap map : {OwnerMap::curve, OwnerMap::round_robin, OwnerMap::random})
            for (const int count : {3, 2, 4, 8}) {
                if (!full_tests() && number++ > 0) continue;
                const auto divide = [&](World& world, Ranks& ranks) { distribute(world, ranks, {.map = map}); };
                INFO(all[turn] << " " << count << " " << static_cast<int>(map));
                CHECK(run_on_ranks_differs(scene, whole, count, 1, divide) == "");
            }
    }
}

TEST_CASE("a divided world refuses to be changed or divided again", "[ranks]") {
    const RankScene scene = own_scene("pile");
    std::string change, division;
    run_on_ranks(2, [&](Ranks& ranks) {
        World world = scene.make(1);
        distribute(world, ranks);
        if (ranks.rank() > 0) return;
        change = message_of([&] { world.remove(world.bodies()[0]); });
        division = message_of([&] { distribute(world, ranks); });
    });
    CHECK(change.find("found a world that is divided among ranks") != std::string::npos);
    CHECK(division.find("found a world that is already divided") != std::string::npos);
}

}  // namespace distribute_test
}  // namespace
}  // namespace skerry::test
