#include "components/shared_union_find.h"

#include <catch2/catch.hpp>
#include <random>
#include <thread>
#include <vector>

#include "components/union_find.h"

namespace skerry::test::shared_union_find_test {

TEST_CASE("sets that threads join at the same time are those of one thread", "[unit]") {
    constexpr Index count = 300;
    constexpr int threads = 4;
    SharedUnionFind shared;  // one object for all seeds: contents of an earlier start must not be visible
    UnionFind twin;
    for (unsigned seed = 0; seed < 60; ++seed) {
        INFO("seed " << seed);
        if (seed == 30) shared.now = std::numeric_limits<std::uint32_t>::max();  // all stamps are used
        std::mt19937 random(seed);
        std::vector<std::pair<Index, Index>> joins(random() % 400);
        for (auto& [a, b] : joins) {
            a = static_cast<Index>(random() % count);
            b = static_cast<Index>(random() % count);
        }
        shared.start(count);
        twin.start(count);
        for (const auto& [a, b] : joins) twin.join(a, b);
        const auto run = [&](auto&& work) {
            std::vector<std::thread> team;
            for (int t = 0; t < threads; ++t) team.emplace_back([&, t] { work(t); });
            for (std::thread& thread : team) thread.join();
        };
        run([&](int t) {
            for (std::size_t i = static_cast<std::size_t>(t); i < joins.size(); i += threads)
                shared.join(joins[i].first, joins[i].second);
        });
        run([&](int t) {
            for (Index i = t; i < count; i += threads)
                if (i % 3 != 0) shared.begin_with(shared.root(i), count - i);
        });
        std::vector<Index> first(count, no_index);
        for (Index i = count - 1; i >= 0; --i)
            if (i % 3 != 0 && first[twin.root(i)] == no_index) first[twin.root(i)] = count - i;
        for (Index i = 0; i < count; ++i) {
            REQUIRE(shared.root(i) == twin.root(i));
            REQUIRE(shared.first_item(shared.root(i)) == first[twin.root(i)]);
        }
    }
}

}  // namespace skerry::test::shared_union_find_test
