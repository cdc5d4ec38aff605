#include "jobs/team.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/jobs/executors.h"

namespace skerry::test::team_test {

namespace {

/// Offsets of phases with these numbers of blocks.
std::vector<Index> offsets(const std::vector<Index>& sizes) {
    std::vector<Index> offset{0};
    for (const Index size : sizes) offset.push_back(offset.back() + size);
    return offset;
}

}  // namespace

TEST_CASE("every block of a team runs once, after all blocks of earlier phases, run after run", "[unit]") {
    const std::vector<Index> offset = offsets({7, 0, 1, 16, 3, 64, 1, 1, 20, 0});
    const auto blocks = static_cast<std::size_t>(offset.back());
    Team team;
    for (const ExecutorChoice& choice : executor_choices({1, 2, 3, 4, 8})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (int gathering = 0; gathering < 5; ++gathering) {
            std::vector<int> runs(blocks, 0), seen(blocks, 0);  // plain ints: the thread sanitizer watches them
            int led = 0;
            team.gather(*executor, [&] {
                ++led;
                for (int run = 1; run <= 50; ++run)
                    team.run_phases(offset, [&](Index block) {
                        const auto b = static_cast<std::size_t>(block);
                        ++runs[b];
                        std::size_t phase_begin = 0;
                        for (const Index begin : offset)
                            if (begin <= block) phase_begin = static_cast<std::size_t>(begin);
                        for (std::size_t earlier = 0; earlier < phase_begin; ++earlier)
                            seen[b] += runs[earlier] == run ? 1 : 1000;
                    });
            });
            REQUIRE(led == 1);
            for (std::size_t b = 0; b < blocks; ++b) {
                REQUIRE(runs[b] == 50);
                REQUIRE(seen[b] % 50 == 0);
                REQUIRE(seen[b] < 50 * 1000);
            }
        }
    }
}

TEST_CASE("a team works alone outside of a gathering, and on nothing", "[unit]") {
    Team team;
    int runs = 0;
    team.run_blocks(5, [&](Index block) { runs += block; });
    CHECK(runs == 10);
    team.run_blocks(0, [&](Index) { ++runs; });
    team.run_phases({}, [&](Index) { ++runs; });
    CHECK(runs == 10);
    const auto executor = make_executor(available_backends().front(), 2);
    team.gather(*executor, [] {});
}

TEST_CASE("the exception of a team's lowest block comes out, the other blocks run, and the team is good for more",
          "[unit]") {
    Team team;
    for (const ExecutorChoice& choice : executor_choices({1, 2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        team.gather(*executor, [&] {
            for (int run = 0; run < 20; ++run) {
                std::atomic<int> finished{0};
                REQUIRE_THROWS_WITH(team.run_phases(offsets({8, 8, 4}),
                                                    [&](Index block) {
                                                        if (block == 17 || block == 3 || block == 5)
                                                            throw std::runtime_error("block " + std::to_string(block));
                                                        ++finished;
                                                    }),
                                    "block 3");
                REQUIRE(finished == 17);
            }
        });
        REQUIRE_THROWS_WITH(team.gather(*executor, [] { throw std::runtime_error("leader"); }), "leader");
        int sum = 0;
        team.gather(*executor, [&] { team.run_phases(offsets({1, 1, 1}), [&](Index block) { sum += block; }); });
        REQUIRE(sum == 3);
    }
}

TEST_CASE("the workers of a team are at work at the same time", "[unit]") {
    Team team;
    for (const ExecutorChoice& choice : executor_choices({2})) {
        if (choice.backend == Backend::serial || std::thread::hardware_concurrency() < 2) continue;
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::atomic<int> inside{0};
        std::atomic<bool> met{false};
        const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(100);
        team.gather(*executor, [&] {
            while (!met && std::chrono::steady_clock::now() < patience)
                team.run_blocks(2, [&](Index) {
                    if (++inside == 2) met = true;
                    const auto moment = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
                    while (!met && std::chrono::steady_clock::now() < moment) std::this_thread::yield();
                    --inside;
                });
        });
        REQUIRE(met);
    }
}

TEST_CASE("a team may gather within a block and within a stage of its executor", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices({1, 2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::vector<Team> teams(4);
        std::vector<int> sums(4, 0);
        executor->run_blocks(4, [&](Index t) {
            const auto own = static_cast<std::size_t>(t);
            teams[own].gather(*executor, [&] {
                std::vector<int> rows(40, 0);
                for (int run = 0; run < 10; ++run)
                    teams[own].run_phases(offsets({20, 20}),
                                          [&](Index block) { ++rows[static_cast<std::size_t>(block)]; });
                sums[own] = std::accumulate(rows.begin(), rows.end(), 0);
            });
        });
        REQUIRE(sums == std::vector<int>(4, 400));
    }
}

}  // namespace skerry::test::team_test
