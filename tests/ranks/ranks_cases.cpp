#include "tests/ranks/ranks_cases.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace skerry::test {

namespace {

void require(bool good, const char* claim) {
    if (!good) throw std::runtime_error(std::string("this is not true: ") + claim);
}

/// Returns the text that rank `from` sends to rank `to`: its length and content differ for all pairs.
RankMessage message_of(int from, int to) {
    return RankMessage(static_cast<std::size_t>(10 * from + to), static_cast<std::byte>(from + 1));
}

std::vector<int> others_of(const Ranks& ranks) {
    std::vector<int> others;
    for (int rank = 0; rank < ranks.size(); ++rank)
        if (rank != ranks.rank()) others.push_back(rank);
    return others;
}

void exchange_with_all(Ranks& ranks) {
    const std::vector<int> peers = others_of(ranks);
    std::vector<RankMessage> out, in(peers.size(), RankMessage(1000));
    std::uint64_t bytes = 0;
    for (const int peer : peers) bytes += out.emplace_back(message_of(ranks.rank(), peer)).size();
    const RankTraffic before = ranks.traffic();
    constexpr std::uint64_t rounds = 3;
    for (std::uint64_t round = 0; round < rounds; ++round) {
        ranks.exchange(peers, out, in);
        for (std::size_t i = 0; i < peers.size(); ++i)
            require(in[i] == message_of(peers[i], ranks.rank()), "each rank receives the message for it");
    }
    const RankTraffic now = ranks.traffic();
    require(now.exchanges == before.exchanges + rounds && now.messages == before.messages + rounds * peers.size() &&
                now.bytes == before.bytes + rounds * bytes,
            "the traffic counts calls, messages and bytes");
}

/// Ranks 0 and 1 exchange several messages, which the others do not take part in.
void exchange_of_two(Ranks& ranks) {
    if (ranks.rank() > 1) return;
    const std::vector<int> peers{1 - ranks.rank()};
    for (std::byte round{0}; round < std::byte{20}; round = std::byte(std::to_integer<int>(round) + 1)) {
        const std::vector<RankMessage> out{RankMessage(100'000, round)};
        std::vector<RankMessage> in(1);
        ranks.exchange(peers, out, in);
        require(in == out, "messages arrive in the order in which they were sent, and long ones too");
    }
    constexpr std::size_t piece = std::size_t{1} << 24;  // MPI gets longer messages in pieces
    for (const std::size_t bytes : {piece - 1, piece, 5 * piece / 2, std::size_t{0}}) {
        std::vector<RankMessage> out{RankMessage(bytes)}, in(1);
        for (std::size_t i = 0; i < bytes; ++i) out[0][i] = static_cast<std::byte>(i % 251);
        ranks.exchange(peers, out, in);
        require(in == out, "messages in pieces arrive complete");
    }
}

struct Extremes {
    double least;
    std::int32_t most, count;
};

void combine_extremes(Extremes& into, const Extremes& from) {
    into = {std::min(into.least, from.least), std::max(into.most, from.most), into.count + from.count};
}

void add_counts(std::uint64_t& into, std::uint64_t from) {
    into += from;
}

void reductions(Ranks& ranks) {
    const int size = ranks.size();
    for (int round = 0; round < 3; ++round) {
        std::uint64_t count = std::uint64_t{1} << 40;
        reduce<add_counts>(ranks, count);
        require(count == static_cast<std::uint64_t>(size) << 40, "counts are added");
        Extremes mine{1.0 / (1 + ranks.rank()), ranks.rank(), 1};
        reduce<combine_extremes>(ranks, mine);
        require(mine.least == 1.0 / size && mine.most == size - 1 && mine.count == size,
                "a record of several values, of another size, is reduced");
    }
}

void gatherings(Ranks& ranks) {
    const RankMessage mine = message_of(ranks.rank(), 0);
    std::vector<RankMessage> expected;
    for (int rank = 0; rank < ranks.size(); ++rank) expected.push_back(message_of(rank, 0));
    require(ranks.gather_everywhere(mine) == expected, "all ranks have the messages of all");
    require(ranks.gather_everywhere({}) == std::vector<RankMessage>(expected.size()), "empty messages are gathered");
    const std::vector<RankMessage> gathered = ranks.gather(mine);
    require(gathered == (ranks.rank() == 0 ? expected : std::vector<RankMessage>()),
            "rank 0 has the messages of all, and the others have none");
}

constexpr RanksCase cases[] = {{"messages between all ranks", exchange_with_all},
                               {"messages between two of the ranks", exchange_of_two},
                               {"reductions", reductions},
                               {"gathered messages", gatherings}};

}  // namespace

std::span<const RanksCase> ranks_cases() {
    return cases;
}

}  // namespace skerry::test
