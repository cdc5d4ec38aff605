#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <sstream>

#include "engine/world/world_state.h"
#include "jobs/team.h"
#include "profiling/scaling/recording_executor.h"
#include "tests/unit/profiling/hand_made.h"

namespace skerry::test::recording_test {

using namespace skerry::profiling;

namespace {

std::vector<PieceKind> kinds(const Recording& recording) {
    std::vector<PieceKind> all;
    for (const Piece& piece : recording.pieces) all.push_back(piece.kind);
    return all;
}

/// Balls pressed into each other; one of the regions is large enough for a Team.
World pressed_balls() {
    World world;
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5});
    world.add_collider(Plane{});
    const Mesh ball = mesh::ball(0.05, 6);
    for (int i = 0; i < 6; ++i)
        world.add_body(ball,
                       {.material = rubber, .position = {0.01 * (i % 2), 0, 0.06 + 0.105 * i}, .velocity = {0, 0, -2}});
    WorldAccess::state_of(world).scratch.parameters.solver.parallel_region_contacts = 8;
    return world;
}

std::uint64_t hash_after_steps(World& world) {
    REQUIRE(world.advance(0.03).ok());
    REQUIRE(world.report().inline_steps == 0);
    return world.state_hash();
}

}  // namespace

TEST_CASE("a recording has the stages, their loops and the time between them", "[unit]") {
    RecordingExecutor executor(64);
    CHECK(executor.worker_count() == 64);
    const std::array<Index, 3> offset{0, 1, 1};
    const std::array<Index, 1> successor{1};
    const std::array<Index, 2> predecessors{0, 1};
    executor.begin();
    int sum = 0;
    executor.run_blocks(2, [&](Index block) { sum += block; });
    executor.run_graph({offset, successor, predecessors}, [&](Index stage) {
        if (stage == 0) executor.run_blocks(3, [&](Index block) { sum += 10 * block; });
    });
    const Recording recording = executor.end();
    CHECK(sum == 31);
    REQUIRE(recording.graph.stage_count() == 2);
    CHECK(recording.graph.successor == std::vector<Index>{1});
    REQUIRE(recording.runs.size() == 4);
    CHECK(recording.runs[0].stage == no_index);
    CHECK(recording.runs[1].stage == 0);
    CHECK(recording.runs[2].stage == 1);
    CHECK(recording.runs[3].stage == no_index);
    using enum PieceKind;
    CHECK(kinds(recording) == std::vector<PieceKind>{serial, loop, serial, serial, loop, serial, serial, serial});
    CHECK(recording.pieces[1].blocks.size() == 2);
    CHECK(recording.pieces[4].blocks.size() == 3);
    CHECK(recording.seconds.size() == 11);
}

TEST_CASE("blocks within a block count as part of it", "[unit]") {
    RecordingExecutor executor(4);
    executor.begin();
    int count = 0;
    executor.run_blocks(3, [&](Index) { executor.run_blocks(5, [&](Index) { ++count; }); });
    const Recording recording = executor.end();
    CHECK(count == 15);
    CHECK(recording.seconds.size() == 1 + 3 + 1);
}

TEST_CASE("the phases of a team are recorded one by one", "[unit]") {
    RecordingExecutor executor(4);
    Team team;
    const std::array<Index, 4> offset{0, 2, 2, 5};
    executor.begin();
    std::vector<Index> order;
    team.gather(executor, [&] { team.run_phases(offset, [&](Index block) { order.push_back(block); }); });
    const Recording recording = executor.end();
    CHECK(order == std::vector<Index>{0, 1, 2, 3, 4});
    using enum PieceKind;
    REQUIRE(kinds(recording) == std::vector<PieceKind>{serial, phase, phase, serial});
    CHECK(recording.pieces[1].blocks.size() == 2);
    CHECK(recording.pieces[2].blocks.size() == 3);
    team.run_blocks(1, [&](Index block) { order.push_back(block); });  // the team no longer belongs to the executor
    CHECK(order.size() == 6);
}

TEST_CASE("the exception of the lowest block comes out of a recording", "[unit]") {
    RecordingExecutor executor(4);
    executor.begin();
    int done = 0;
    CHECK_THROWS_WITH(executor.run_blocks(4,
                                          [&](Index block) {
                                              ++done;
                                              if (block > 0) throw std::runtime_error(std::to_string(block));
                                          }),
                      "1");
    CHECK(done == 4);
    executor.run_blocks(1, [](Index) {});
    CHECK(executor.end().seconds.size() == 1 + 4 + 1 + 1 + 1);
}

TEST_CASE("a world that is recorded ends in the same state", "[unit]") {
    World plain = pressed_balls(), recorded = pressed_balls(), again = pressed_balls();
    const std::uint64_t expected = hash_after_steps(plain);
    std::vector<Recording> recordings;
    for (World* const world : {&recorded, &again}) {
        auto owned = std::make_unique<RecordingExecutor>(64);
        RecordingExecutor& executor = *owned;
        WorldAccess::state_of(*world).executor = std::move(owned);
        executor.begin();
        CHECK(hash_after_steps(*world) == expected);
        recordings.push_back(executor.end());
    }
    CHECK(recordings[0].same_work(recordings[1]));
    const std::vector<PieceKind> all = kinds(recordings[0]);
    CHECK(std::ranges::count(all, PieceKind::loop) > 50);
    CHECK(std::ranges::count(all, PieceKind::phase) > 10);
    CHECK(recordings[0].critical_path() < recordings[0].work());
}

TEST_CASE("of several recordings each block has its time without interruptions", "[unit]") {
    std::vector<Recording> recordings(3, graph_of({{serial(1), loop({2, 3})}}, {}));
    recordings[0].seconds[1] = 100;  // this piece was interrupted
    recordings[2].seconds[2] = 50;
    CHECK(undisturbed(recordings).seconds == std::vector<double>{1, 2, 3});
    recordings[1] = graph_of({{serial(1), loop({2, 3, 4})}}, {});
    CHECK_THROWS_AS(undisturbed(recordings), std::runtime_error);
}

TEST_CASE("a recording is written piece by piece", "[unit]") {
    std::ostringstream text;
    const std::vector<std::string> names{"stage"};
    write_csv(graph_of({{serial(1e-6), loop({2e-6, 3e-6})}}, {}), names, text);
    CHECK(text.str() == "run,stage,kind,us\n0,stage,serial,1\n0,stage,loop,2 3\n");
}

}  // namespace skerry::test::recording_test
