// The host owns the threads: guarantees for a host that uses oneTBB itself.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>
#include <vector>

#include "jobs/executor.h"

namespace skerry::test::backend_tbb_test {

TEST_CASE("with 0 workers the work stays in the caller's arena", "[unit]") {
    const auto executor = make_executor(Backend::tbb, 0);
    tbb::task_arena host(3);
    std::atomic<int> elsewhere{0};
    host.execute([&] {
        REQUIRE(executor->worker_count() == 3);
        executor->run_blocks(100, [&](Index) {
            if (tbb::this_task_arena::max_concurrency() != 3) ++elsewhere;
        });
    });
    REQUIRE(elsewhere == 0);
}

TEST_CASE("with a number of workers the work stays in an arena of that size, nested work too", "[unit]") {
    const auto executor = make_executor(Backend::tbb, 3);
    std::atomic<int> elsewhere{0};
    executor->run_blocks(10, [&](Index) {
        executor->run_blocks(10, [&](Index) {
            if (tbb::this_task_arena::max_concurrency() != 3 || tbb::this_task_arena::current_thread_index() >= 3)
                ++elsewhere;
        });
    });
    REQUIRE(elsewhere == 0);
}

TEST_CASE("a host that cancels its tasks does not make us leave out blocks or stages", "[unit]") {
    const auto executor = make_executor(Backend::tbb, 0);
    tbb::task_group_context context;
    std::atomic<int> blocks{0}, stages{0};
    tbb::task_arena host(2);
    host.execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<int>(0, 1),
            [&](const tbb::blocked_range<int>&) {
                context.cancel_group_execution();
                executor->run_blocks(50, [&](Index) { ++blocks; });
                const std::vector<Index> offset{0, 0, 0, 0}, count{0, 0, 0};
                executor->run_graph({offset, {}, count}, [&](Index) { ++stages; });
            },
            context);
    });
    REQUIRE(blocks == 50);
    REQUIRE(stages == 3);
}

TEST_CASE("a worker that waits for blocks starts no other stage meanwhile", "[unit]") {
    // Many independent stages, and blocks that last longer on a helper: the owner of a stage often has to wait for its
    // last block while other stages are ready. Blocks sleep instead of work, so that this also happens with few cores.
    const auto executor = make_executor(Backend::tbb, 4);
    const std::vector<Index> offset(17, 0), count(16, 0);
    std::atomic<int> interrupted{0};
    for (int run = 0; run < 20; ++run) {
        executor->run_graph({offset, {}, count}, [&](Index) {
            thread_local int stages_on_this_thread = 0;
            if (++stages_on_this_thread > 1) ++interrupted;
            const auto owner = std::this_thread::get_id();
            executor->run_blocks(6, [owner](Index) {
                std::this_thread::sleep_for(std::chrono::microseconds(std::this_thread::get_id() == owner ? 20 : 400));
            });
            --stages_on_this_thread;
        });
    }
    REQUIRE(interrupted == 0);
}

}  // namespace skerry::test::backend_tbb_test
