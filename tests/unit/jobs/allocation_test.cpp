// Counts calls of operator new: a graph that has run before must not allocate.
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "components/types.h"
#include "jobs/reduce.h"
#include "jobs/task_graph.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::jobs_allocation_test {

namespace {

// A thread that a library starts late allocates when it starts, which cannot be avoided here. Therefore every worker
// takes one block and waits for the others.
void wait_for_all_workers(Executor& executor) {
    std::atomic<int> here{0};
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(100);
    executor.run_blocks(executor.worker_count(), [&](Index) {
        ++here;
        while (here < executor.worker_count() && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
    });
}

}  // namespace

TEST_CASE("the counter of this test counts", "[unit]") {
    const long before = allocations;
    Column<Real> column;
    column.resize(10);
    REQUIRE(allocations == before + 1);
}

TEST_CASE("a graph with blocks and sums inside allocates nothing once it has run", "[unit]") {
    Column<Real> rows, sums, partial, others, results;
    rows.resize(1000);
    others.resize(1000);
    results.resize(1);
    Real h = 0.5;
    TaskGraph graph;
    const auto fill = [](Executor& executor, Real value_of_row, std::span<Real> out) {
        parallel_for(executor, out.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row) out[row] = value_of_row;
        });
    };
    graph.stage("one", fill, value(h), write(rows));
    graph.stage("two", fill, value(h), write(others));
    graph.stage(
        "sum",
        [&partial](Executor& executor, std::span<const Real> in, std::span<Real> out) {
            out[0] = reduce(
                executor, in.size(), 16, partial, 0.0,
                [&](std::size_t begin, std::size_t end) { return in[begin] * static_cast<Real>(end - begin); },
                [](Real a, Real b) { return a + b; });
        },
        read(rows), write(results));
    graph.stage("never", fill, value(h), write(rows), only_if([](Real step) { return step > 1; }, value(h)));
    graph.compile();

    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        wait_for_all_workers(*executor);
        for (int run = 0; run < 20; ++run) graph.run(*executor);
        const long before = allocations;
        for (int run = 0; run < 200; ++run) graph.run(*executor);
        const long asked = allocations - before;
        REQUIRE(asked == 0);
    }
    graph.run_inline();
    const long before = allocations;
    graph.run_inline();
    REQUIRE(allocations == before);
    REQUIRE(results[0] == 500);
}

}  // namespace skerry::test::jobs_allocation_test
