#include "jobs/run_tasks.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace skerry::test::run_tasks_test {

using namespace std::chrono_literals;

TEST_CASE("every task runs once, away from the calling thread, which watches until the last one has returned",
          "[unit]") {
    const std::thread::id caller = std::this_thread::get_id();
    for (const int threads : {1, 2, 5, 100})
        for (const Index count : {0, 1, 3, 200}) {
            CAPTURE(threads, count);
            std::vector<int> runs(static_cast<std::size_t>(count), 0);  // plain ints: the thread sanitizer watches them
            std::atomic<bool> elsewhere{true}, watched_here{true};
            run_tasks(
                count, threads,
                [&](Index task) {
                    ++runs[static_cast<std::size_t>(task)];
                    if (std::this_thread::get_id() == caller) elsewhere = false;
                },
                1ms,
                [&] {
                    if (std::this_thread::get_id() != caller) watched_here = false;
                });
            CHECK(runs == std::vector<int>(static_cast<std::size_t>(count), 1));
            CHECK(elsewhere);
            CHECK(watched_here);
        }
    std::atomic<int> looks{0};
    run_tasks(
        1, 1,
        [&](Index) {
            while (looks < 3) std::this_thread::yield();  // never ends without calls of the watching thread
        },
        1ms, [&] { ++looks; });
    CHECK(looks >= 3);
}

TEST_CASE("tasks run at the same time on as many threads as wanted", "[unit]") {
    std::atomic<int> inside{0};
    run_tasks(
        3, 3,
        [&](Index) {
            ++inside;
            while (inside < 3) std::this_thread::yield();  // never ends with fewer threads
        },
        1ms, [] {});
    CHECK(inside == 3);
}

TEST_CASE("after an exception no further task starts, and the lowest exception arrives", "[unit]") {
    for (int run = 0; run < 50; ++run) {
        std::atomic<int> started{0};
        std::string caught;
        try {
            run_tasks(
                1000, 4,
                [&](Index task) {
                    ++started;
                    if (task == 3) std::this_thread::sleep_for(1ms);
                    if (task >= 3) throw std::runtime_error(std::to_string(task));
                },
                1ms, [] {});
        } catch (const std::runtime_error& error) {
            caught = error.what();
        }
        CHECK(caught == "3");
        CHECK(started < 1000);
    }
}

TEST_CASE("an exception of the watching thread arrives after the running tasks have returned", "[unit]") {
    std::atomic<int> started{0}, returned{0};
    CHECK_THROWS_WITH(run_tasks(
                          1000, 2,
                          [&](Index) {
                              ++started;
                              std::this_thread::sleep_for(5ms);
                              ++returned;
                          },
                          1ms, [] { throw std::runtime_error("enough"); }),
                      "enough");
    CHECK(started == returned);
    CHECK(started < 1000);
}

}  // namespace skerry::test::run_tasks_test
