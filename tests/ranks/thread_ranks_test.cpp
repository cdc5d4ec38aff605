#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <exception>
#include <functional>
#include <string>

#include "tests/ranks/ranks_cases.h"
#include "tests/ranks/thread_ranks.h"

namespace skerry::test {
namespace {
namespace thread_ranks_test {

void take_smaller(double& into, double from) {
    into = std::min(into, from);
}

TEST_CASE("ranks that are threads exchange messages and reduce records") {
    for (const RanksCase& test : ranks_cases()) {
        INFO(test.name);
        CHECK_NOTHROW(run_on_ranks(3, test.run));
    }
}

TEST_CASE("ranks that are threads report calls that do not match, and deadlocks") {
    const auto message_of_run = [](const std::function<void(Ranks&)>& run) {
        try {
            run_on_ranks(2, run);
        } catch (const std::exception& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    double value = 1;
    CHECK(message_of_run([&](Ranks& ranks) {
              if (ranks.rank() == 0)
                  ranks.gather({});
              else
                  ranks.gather_everywhere({});
          }).find("which called gather") != std::string::npos);
    CHECK(message_of_run([&](Ranks& ranks) {
              if (ranks.rank() == 0) reduce<take_smaller>(ranks, value);
          }).find("rank 0 for rank 1") != std::string::npos);
}

TEST_CASE("a message between ranks that are threads takes as long as it shall") {
    constexpr std::chrono::milliseconds delay(20);
    const auto start = std::chrono::steady_clock::now();
    run_on_ranks(
        2, [](Ranks& ranks) { ranks.gather_everywhere({}); }, delay);
    CHECK(std::chrono::steady_clock::now() - start >= delay);
}

}  // namespace thread_ranks_test
}  // namespace
}  // namespace skerry::test
