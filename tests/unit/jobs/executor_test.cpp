#include "jobs/executor.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cfenv>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "jobs/parallel_for.h"
#include "tests/unit/jobs/executors.h"
#include "tests/unit/jobs/random_graph.h"

namespace skerry::test::executor_test {

TEST_CASE("the backends of the build end with serial, and each makes an executor of its own kind", "[unit]") {
    REQUIRE(available_backends().back() == Backend::serial);
    for (Backend backend : available_backends()) {
        CAPTURE(name_of(backend));
        REQUIRE(make_executor(backend, 1)->backend() == backend);
        REQUIRE(make_executor(backend, 1)->worker_count() == 1);
        REQUIRE(make_executor(backend, 3)->worker_count() == (backend == Backend::serial ? 1 : 3));
        REQUIRE(make_executor(backend, 0)->worker_count() >= 1);
    }
}

TEST_CASE("a backend that was not built, or a negative number of workers, is refused by name", "[unit]") {
    REQUIRE_THROWS_AS(make_executor(available_backends().front(), -1), std::invalid_argument);
    for (const auto& [backend, name] : EnumNames<Backend>::table) {
        const auto built = available_backends();
        if (backend == Backend::automatic || std::find(built.begin(), built.end(), backend) != built.end()) continue;
        REQUIRE_THROWS_WITH(make_executor(backend, 1), Catch::Contains(std::string(name)));
    }
}

TEST_CASE("blocks and stages calculate alike, whatever the host has set, and the host's thread is left as it was",
          "[unit]") {
#if defined(__SSE2__)
    const auto odd = [] {  // true if denormal numbers are kept, or if sums are not rounded to nearest
        volatile Real smallest = std::numeric_limits<Real>::min(), one = 1, tiny = 0x1p-60;
        return smallest / 2 > 0 || one + tiny > 1;
    };
    const RandomGraph graph(5, 30, 0.1);
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::atomic<int> odd_blocks{0}, odd_stages{0};
        std::fesetround(FE_UPWARD);
        executor->run_blocks(64, [&](Index) { odd_blocks += odd(); });
        executor->run_graph(graph.edges(), [&](Index) { odd_stages += odd(); });
        const bool host_is_odd = odd();
        std::fesetround(FE_TONEAREST);
        CHECK(odd_blocks == 0);
        CHECK(odd_stages == 0);
        CHECK(host_is_odd);
    }
#endif
}

TEST_CASE("every block runs exactly once", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (Index count : {0, 1, 2, 3, 7, 64, 1000}) {
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count) + 1);
            executor->run_blocks(count, [&](Index block) { ++runs[static_cast<std::size_t>(block)]; });
            for (Index block = 0; block < count; ++block) REQUIRE(runs[static_cast<std::size_t>(block)] == 1);
            REQUIRE(runs.back() == 0);
        }
    }
}

TEST_CASE("after run_blocks all results of its blocks are visible, run after run", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::vector<int> rows(97, 0);  // plain ints: the thread sanitizer watches them
        for (int run = 0; run < 200; ++run)
            executor->run_blocks(97, [&](Index block) { ++rows[static_cast<std::size_t>(block)]; });
        REQUIRE(std::count(rows.begin(), rows.end(), 200) == 97);
    }
}

TEST_CASE("blocks may run blocks, three deep", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::vector<int> rows(5 * 6 * 7, 0);
        executor->run_blocks(5, [&](Index i) {
            executor->run_blocks(6, [&](Index j) {
                executor->run_blocks(7, [&](Index k) { ++rows[static_cast<std::size_t>((i * 6 + j) * 7 + k)]; });
            });
        });
        REQUIRE(std::count(rows.begin(), rows.end(), 1) == 5 * 6 * 7);
    }
}

TEST_CASE("several threads may run blocks on one executor at once", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::vector<std::vector<int>> rows(3, std::vector<int>(50, 0));
        std::vector<std::thread> hosts;
        for (auto& mine : rows)
            hosts.emplace_back([&executor, &mine] {
                for (int run = 0; run < 20; ++run)
                    executor->run_blocks(50, [&](Index block) { ++mine[static_cast<std::size_t>(block)]; });
            });
        for (std::thread& host : hosts) host.join();
        for (const auto& mine : rows) REQUIRE(std::count(mine.begin(), mine.end(), 20) == 50);
    }
}

TEST_CASE("the exception of the lowest block comes out, the other blocks run, and the executor is good for more",
          "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (int run = 0; run < 10; ++run) {
            std::atomic<int> finished{0};
            REQUIRE_THROWS_WITH(executor->run_blocks(20,
                                                     [&](Index block) {
                                                         if (block == 17 || block == 3 || block == 9)
                                                             throw std::runtime_error("block " + std::to_string(block));
                                                         ++finished;
                                                     }),
                                "block 3");
            REQUIRE(finished == 17);
        }
        REQUIRE_NOTHROW(executor->run_blocks(20, [](Index) {}));
        REQUIRE_THROWS_WITH(executor->run_blocks(1, [](Index) { throw std::runtime_error("alone"); }), "alone");
    }
}

TEST_CASE("every stage runs once, after all that it waits for", "[unit]") {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        const RandomGraph graph(seed, 1 + static_cast<int>(seed) * 5, seed % 3 == 0 ? 0.02 : 0.15);
        const auto stages = static_cast<std::size_t>(graph.stage_count());
        for (const ExecutorChoice& choice : executor_choices()) {
            CAPTURE(seed, choice.text());
            const auto executor = choice.make();
            for (int run = 0; run < 3; ++run) {
                std::atomic<int> clock{0};
                std::vector<int> begin(stages, -1), end(stages, -1), runs(stages, 0);
                executor->run_graph(graph.edges(), [&](Index stage) {
                    const auto s = static_cast<std::size_t>(stage);
                    begin[s] = clock++;
                    ++runs[s];
                    end[s] = clock++;
                });
                for (std::size_t from = 0; from < stages; ++from) {
                    REQUIRE(runs[from] == 1);
                    for (Index e = graph.successor_offset[from]; e < graph.successor_offset[from + 1]; ++e)
                        REQUIRE(end[from] <
                                begin[static_cast<std::size_t>(graph.successor[static_cast<std::size_t>(e)])]);
                }
            }
        }
    }
}

TEST_CASE("a graph without stages, and one of a single stage, return", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        int runs = 0;
        executor->run_graph(RandomGraph(1, 0, 0).edges(), [&](Index) { ++runs; });
        REQUIRE(runs == 0);
        executor->run_graph(RandomGraph(1, 1, 0).edges(), [&](Index) { ++runs; });
        REQUIRE(runs == 1);
    }
}

TEST_CASE("stages may run blocks, which may run blocks", "[unit]") {
    const RandomGraph graph(5, 20, 0.1);
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (int run = 0; run < 5; ++run) {
            std::vector<int> rows(20 * 8 * 4, 0);
            executor->run_graph(graph.edges(), [&](Index stage) {
                executor->run_blocks(8, [&](Index i) {
                    executor->run_blocks(4,
                                         [&](Index j) { ++rows[static_cast<std::size_t>((stage * 8 + i) * 4 + j)]; });
                });
            });
            REQUIRE(std::count(rows.begin(), rows.end(), 1) == 20 * 8 * 4);
        }
    }
}

TEST_CASE("after an exception no stage that waits for it starts, and the executor is good for more", "[unit]") {
    // 0 -> 1 -> 2 -> ... -> 9
    std::vector<Index> offset, successor, count;
    for (Index s = 0; s < 10; ++s) {
        offset.push_back(s);
        if (s < 9) successor.push_back(s + 1);
        count.push_back(s > 0 ? 1 : 0);
    }
    offset.push_back(9);
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        int last = -1;
        REQUIRE_THROWS_WITH(executor->run_graph({offset, successor, count},
                                                [&](Index stage) {
                                                    if (stage == 4) throw std::runtime_error("stage 4");
                                                    last = stage;
                                                }),
                            "stage 4");
        REQUIRE(last == 3);
        REQUIRE_NOTHROW(executor->run_graph({offset, successor, count}, [&](Index stage) { last = stage; }));
        REQUIRE(last == 9);
    }
}

TEST_CASE("of several stages that throw, the lowest is heard", "[unit]") {
    const RandomGraph graph(1, 2, 0);
    for (const ExecutorChoice& choice : executor_choices({2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::atomic<int> started{0};
        // Each stage waits for the other to start; then both throw. On a single core the wait may end too early: then
        // only stage 0, which starts first, throws.
        REQUIRE_THROWS_WITH(executor->run_graph(graph.edges(),
                                                [&](Index stage) {
                                                    ++started;
                                                    const auto patience = std::chrono::steady_clock::now() +
                                                                          std::chrono::milliseconds(50);
                                                    while (started < 2 && std::chrono::steady_clock::now() < patience)
                                                        std::this_thread::yield();
                                                    throw std::runtime_error("stage " + std::to_string(stage));
                                                }),
                            "stage 0");
    }
}

TEST_CASE("independent stages run at the same time, and the caller is one of the workers", "[unit]") {
    const RandomGraph graph(1, 2, 0);
    for (const ExecutorChoice& choice : executor_choices({2})) {
        if (choice.backend == Backend::serial || std::thread::hardware_concurrency() < 2) continue;
        CAPTURE(choice.text());
        const auto executor = choice.make();
        std::atomic<int> inside{0};
        std::atomic<bool> met{false};
        // Workers of oneTBB yield a hundred times before they leave the arena of a destroyed executor: seconds on a
        // crowded machine.
        executor->run_graph(graph.edges(), [&](Index) {
            if (++inside == 2) met = true;
            const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(100);
            while (!met && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
            --inside;
        });
        REQUIRE(met);
    }
}

TEST_CASE("parallel_for covers the rows with blocks that do not depend on the worker count", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (std::size_t count : {0u, 1u, 9u, 10u, 11u, 20u, 105u}) {
            std::vector<int> runs(count, 0);
            std::atomic<bool> fixed{true};
            parallel_for(*executor, count, 10, [&](std::size_t begin, std::size_t end) {
                if (begin % 10 != 0 || end != std::min<std::size_t>(begin + 10, count)) fixed = false;
                for (std::size_t row = begin; row < end; ++row) ++runs[row];
            });
            REQUIRE(fixed);
            REQUIRE(std::count(runs.begin(), runs.end(), 1) == static_cast<std::ptrdiff_t>(count));
        }
    }
}

TEST_CASE("an executor that was never used, and one that just worked, end", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        for (int i = 0; i < 20; ++i) {
            const auto unused = choice.make();
            const auto used = choice.make();
            used->run_blocks(10, [](Index) {});
        }
    }
}

}  // namespace skerry::test::executor_test
