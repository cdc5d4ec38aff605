// Every rank holds every body: ranks search for different pairs, and together they find the contacts of one process.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/any_table.h"
#include "engine/world/world_state.h"
#include "tests/ranks/everywhere.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/lively_scene.h"

namespace skerry::test {
namespace {
namespace everywhere_test {

void advance(World& world, Real seconds) {
    if (!world.advance(seconds).ok()) throw std::runtime_error("the world cannot advance");
}

/// Name of a column of motion, or of a table whose rows join bodies, that differs between two worlds. Empty: none.
std::string differing_column(Model& expected, Model& found) {
    if (!std::ranges::equal(expected.nodes.position, found.nodes.position)) return "nodes.position";
    if (!std::ranges::equal(expected.nodes.velocity, found.nodes.velocity)) return "nodes.velocity";
    if (!std::ranges::equal(expected.nodes.push_out, found.nodes.push_out)) return "nodes.push_out";
    std::vector<AnyTable> tables;
    found.for_each_joining([&](const char* name, auto& table, auto&) { tables.emplace_back(table, name); });
    std::string differs;
    auto next = tables.begin();
    expected.for_each_joining([&](const char*, auto& table, auto&) {
        const AnyTable same(table);
        for (const ColumnInfo& info : same.columns()) {
            const AnyColumn a = same.column(info), b = next->column(info);
            if (!is_state(info.role)) continue;
            if (a.size() != b.size() || std::memcmp(a.read(), b.read(), a.size() * a.type().bytes) != 0)
                differs = std::string(next->name()) + "." + info.name;
        }
        ++next;
    });
    return differs;
}

TEST_CASE("each close pair of bodies belongs to one rank", "[ranks]") {
    std::vector<std::uint64_t> alone, divided;
    {
        World world = lively_scene({});
        REQUIRE(world.advance(1e-4).ok());
        const Column<std::uint64_t>& key = WorldAccess::state_of(world).cache.pairs.key;
        alone.assign(key.begin(), key.end());
    }
    std::mutex mutex;
    std::vector<std::size_t> of_rank;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = lively_scene({});
        hold_everywhere(world, ranks);
        advance(world, 1e-4);
        const Column<std::uint64_t>& key = WorldAccess::state_of(world).cache.pairs.key;
        const std::scoped_lock lock(mutex);
        divided.insert(divided.end(), key.begin(), key.end());
        of_rank.push_back(key.size());
    });
    std::ranges::sort(divided);
    CHECK(divided == alone);
    CHECK(std::ranges::min(of_rank) > 0);
}

TEST_CASE("ranks add rounds of labels until a region that spans all of them has one label", "[ranks]") {
    const RankScene scene = scene_of_file("tests/ranks/scenes/one_region.json");
    std::vector<int> rounds(8);
    run_on_ranks(8, [&](Ranks& ranks) {
        World world = scene.make(1);
        hold_everywhere(world, ranks);
        advance(world, 5e-3);
        rounds[static_cast<std::size_t>(ranks.rank())] = WorldAccess::state_of(world).ranks.label_rounds.count;
    });
    CHECK(rounds.front() > LabelRounds::least);
    CHECK(std::ranges::count(rounds, rounds.front()) == 8);
}

/// Boxes that fall onto a plane with a cluster of flat elements at their lower sides.
World flat_bottoms() {
    World world;
    world.add_collider(Plane{});
    const auto soft = world.add_material({.young_modulus = 2e4, .friction = 0.5});
    Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {4, 4, 4});
    for (Vec3& node : mesh.nodes)
        if ((node - Vec3(0, 0, -0.025)).norm() < 1e-9) node.z() = -0.0485;
    for (int i = 0; i < 3; ++i)
        world.add_body(mesh, {.material = soft, .position = {0.02 * i, 0, 0.052 + 0.102 * i}, .velocity = {0, 0, -1}});
    return world;
}

/// Compares two worlds of equal rows, with the impulses on nodes that are held along single directions.
std::string difference_of(WorldState& expected, WorldState& found) {
    const auto impulses = [](const WorldState& state) {
        return std::vector<Vec3>(state.scratch.axis_impulse.begin(), state.scratch.axis_impulse.end());
    };
    std::string difference = differing_column(expected.model, found.model);
    if (difference.empty() && impulses(expected) != impulses(found))
        difference = "impulses on nodes that are held along single directions";
    return difference;
}

TEST_CASE("all ranks have the same motion and the same impulses of joints, ties, cables and held nodes", "[ranks]") {
    constexpr Real seconds = 0.03;
    std::vector<RankScene> scenes;
    for (const char* name : {"pile", "linked", "constraints"})
        scenes.push_back(scene_of_file("tests/ranks/scenes/" + std::string(name) + ".json"));
    scenes.push_back({"bodies with clusters", [](int) { return flat_bottoms(); }, seconds});
    for (const RankScene& scene : scenes) {
        World whole = scene.make(1);
        advance(whole, seconds);
        WorldState& expected = WorldAccess::state_of(whole);
        CHECK(expected.model.clusters.empty() == (scene.name != "bodies with clusters"));
        std::vector<std::string> differs(3);
        run_on_ranks(3, [&](Ranks& ranks) {
            World world = scene.make(1);
            hold_everywhere(world, ranks);
            advance(world, seconds);
            differs[static_cast<std::size_t>(ranks.rank())] = difference_of(expected, WorldAccess::state_of(world));
        });
        INFO(scene.name);
        CHECK(differs == std::vector<std::string>(3));
    }
}

TEST_CASE("the number of rounds of labels follows the need", "[ranks]") {
    LabelRounds rounds;
    rounds.note(3);  // one more than there were
    CHECK(rounds.count == 3);
    rounds.note(4);
    CHECK(rounds.count == 4);
    for (int step = 0; step < 499; ++step) rounds.note(step == 100 ? 3 : 1);
    CHECK(rounds.count == 4);
    rounds.note(1);
    CHECK(rounds.count == 4);  // a number that has grown stays for one period
    for (int step = 0; step < 500; ++step) rounds.note(step == 100 ? 3 : 1);
    CHECK(rounds.count == 3);
    for (int step = 0; step < 500; ++step) rounds.note(1);
    CHECK(rounds.count == LabelRounds::least);
}

}  // namespace everywhere_test
}  // namespace
}  // namespace skerry::test
