#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <exception>
#include <functional>
#include <string>

#include "tests/ranks/thread_ranks.h"

namespace skerry::test {
namespace {
namespace thread_ranks_test {

void take_smaller(std::byte* into, const std::byte* from) {
    double a = 0, b = 0;
    std::memcpy(&a, into, sizeof a);
    std::memcpy(&b, from, sizeof b);
    a = std::min(a, b);
    std::memcpy(into, &a, sizeof a);
}

TEST_CASE("ranks that are threads exchange messages and reduce records") {
    std::vector<double> least(3);
    std::vector<std::size_t> received(3);
    run_on_ranks(3, [&](Ranks& ranks) {
        const auto r = static_cast<std::size_t>(ranks.rank());
        std::vector<int> peers;
        for (int other = 0; other < 3; ++other)
            if (other != ranks.rank()) peers.push_back(other);
        const std::vector<RankMessage> out(2, RankMessage(r + 1));
        std::vector<RankMessage> in(2);
        ranks.exchange(peers, out, in);
        received[r] = in[0].size() + in[1].size();
        double mine = 5.0 - ranks.rank();
        reduce(ranks, mine, take_smaller);
        least[r] = mine;
    });
    CHECK(received == std::vector<std::size_t>{5, 4, 3});
    CHECK(least == std::vector<double>{3, 3, 3});
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
              if (ranks.rank() == 0) reduce(ranks, value, take_smaller);
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
