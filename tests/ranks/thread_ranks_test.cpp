#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

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

}  // namespace thread_ranks_test
}  // namespace
}  // namespace skerry::test
