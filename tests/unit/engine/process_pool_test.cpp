// Jobs that run in their own processes.
#include <sys/syscall.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "engine/program/sweep/process_pool.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::process_pool_test {

namespace {

struct PoolResult {
    skerry::PoolEnd end;
    int most_running = 0;
};

PoolResult run(int count, int at_once, skerry::FunctionRef<int(int)> job, bool after_failure = true) {
    PoolResult result;
    const auto goes_on = [&](int, int code) { return after_failure || code == 0; };
    const auto show = [&](int, int running) { result.most_running = std::max(result.most_running, running); };
    result.end = skerry::run_in_processes(count, at_once, {job, goes_on, show});
    return result;
}

/// Waits up to a minute for a file. Returns false if it does not appear.
bool appears(const std::filesystem::path& file) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!std::filesystem::exists(file)) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

}  // namespace

TEST_CASE("every job runs once, so many at a time", "[unit][processes]") {
    const skerry::TemporaryFolder folder, running;
    const auto job = [&](int index) {
        const std::filesystem::path mark = running.path() / std::to_string(index), done = folder.path();
        std::ofstream(done / std::to_string(index), std::ios::app) << index;
        std::ofstream(mark, std::ios::app) << index;
        // The first three jobs wait for each other, so that they run at the same time.
        for (int other = 0; index < 3 && other < 3; ++other)
            if (!appears(done / std::to_string(other))) return 1;
        const std::filesystem::directory_iterator marks(running.path());
        if (std::distance(begin(marks), end(marks)) > 3) return 2;
        std::filesystem::remove(mark);
        return 0;
    };
    const PoolResult result = run(20, 3, job);
    CHECK(result.end.done == 20);
    CHECK(result.end.lost.empty());
    CHECK(result.most_running <= 3);
    for (int i = 0; i < 20; ++i) {
        std::string text;
        std::ifstream(folder.path() / std::to_string(i)) >> text;
        CHECK(text == std::to_string(i));
    }
    CHECK(run(0, 3, job).end.done == 0);
}

TEST_CASE("a job that ends badly, by itself or by a signal, takes no other with it", "[unit][processes]") {
    const auto job = [](int index) {
        if (index == 1) raise(SIGKILL);
        return index == 3 ? 7 : 0;
    };
    const PoolResult result = run(6, 2, job);
    CHECK(result.end.done == 4);
    REQUIRE(result.end.lost.size() == 2);
    for (const auto& [index, how] : result.end.lost)
        CHECK_THAT(how, Catch::Contains(index == 1 ? "signal 9" : "ended with exit code 7"));
}

TEST_CASE("no job begins after one that says so", "[unit][processes]") {
    const PoolResult result = run(
        100, 1, [](int index) { return index == 4 ? 3 : 0; }, false);
    CHECK(result.end.done == 4);
    CHECK(result.end.lost.size() == 1);
}

TEST_CASE("a signal ends the running jobs, and no job starts after it", "[unit][processes]") {
    const pid_t parent = getpid();
    // The signal goes to the main thread, which waits for it. Threads of earlier tests do not block it, and in one of
    // them it would end this program.
    const auto job = [&](int index) {
        if (index == 1) syscall(SYS_tgkill, parent, parent, SIGINT);
        if (index > 0) pause();
        return 0;
    };
    const PoolResult result = run(100, 2, job);
    CHECK(result.end.signal == SIGINT);
    CHECK(result.end.lost.empty());
    // Job 0 may have ended before the signal, so that a third job started.
    CHECK(result.end.done <= 1);
    CHECK(result.end.done + static_cast<int>(result.end.stopped.size()) >= 2);
    CHECK(result.end.done + static_cast<int>(result.end.stopped.size()) <= 3);
}

}  // namespace skerry::test::process_pool_test
