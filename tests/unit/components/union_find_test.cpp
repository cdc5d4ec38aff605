#include "components/union_find.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <random>
#include <vector>

namespace skerry::test::union_find_test {

namespace {

/// Slow reference: every index stores the smallest index of its set.
struct Labels {
    std::vector<Index> smallest;

    explicit Labels(Index count) : smallest(static_cast<std::size_t>(count)) {
        std::iota(smallest.begin(), smallest.end(), 0);
    }
    void join(Index a, Index b) {
        const Index from = std::max(smallest[a], smallest[b]), to = std::min(smallest[a], smallest[b]);
        for (Index& label : smallest)
            if (label == from) label = to;
    }
};

}  // namespace

TEST_CASE("the root of a set is its smallest index, whatever was joined in which order", "[unit]") {
    constexpr Index count = 60;
    UnionFind sets;  // one object for all seeds: contents of an earlier start must not be visible
    for (unsigned seed = 0; seed < 50; ++seed) {
        INFO("seed " << seed);
        std::mt19937 random(seed);
        Labels twin(count);
        sets.start(count);
        for (auto joins = random() % 80; joins > 0; --joins) {
            const auto a = static_cast<Index>(random() % count), b = static_cast<Index>(random() % count);
            twin.join(a, b);
            sets.join(a, b);
        }
        for (Index i = 0; i < count; ++i) REQUIRE(sets.root(i) == twin.smallest[i]);
    }
}

TEST_CASE("sets are numbered in the order of the first query", "[unit]") {
    UnionFind sets;
    sets.start(6);
    sets.join(5, 1);
    sets.join(0, 3);
    CHECK(sets.number(5) == 0);
    CHECK(sets.number(2) == 1);
    CHECK(sets.number(1) == 0);
    CHECK(sets.number(3) == 2);
    CHECK(sets.number(0) == 2);
    CHECK(sets.number_count == 3);
    sets.start(6);
    CHECK(sets.number(3) == 0);
    CHECK(sets.number_count == 1);
}

TEST_CASE("a start forgets the joins before it, when its stamps are used up as well", "[unit]") {
    UnionFind sets;
    sets.start(3);  // stamp 1
    sets.join(0, 2);
    sets.now = std::numeric_limits<std::uint32_t>::max();
    sets.start(3);  // stamp 1 again
    CHECK(sets.root(2) == 2);
    CHECK(sets.number(2) == 0);
}

}  // namespace skerry::test::union_find_test
