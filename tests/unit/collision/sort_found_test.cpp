#include "systems/collision/search/sort_found.h"

#include <catch2/catch.hpp>
#include <set>
#include <vector>

#include "systems/collision/inputs/contact_key.h"
#include "tests/support/random.h"

namespace skerry::test::sort_found_test {

namespace {

/// Distinct features of all kinds, each with its own number as a label.
Column<FoundCandidate> random_features(test::Random& random, std::size_t count) {
    std::set<std::uint64_t> seen;
    Column<FoundCandidate> found;
    const auto local = [&](Real below) { return static_cast<Index>((random.number() + 1) / 2 * below); };
    while (found.size() < count) {
        const Index first = local(50), second = local(2e9);  // many features of one point
        const int kind = static_cast<int>(local(3));
        const std::uint64_t feature =
            kind == 2 ? edge_edge_feature(first, second) : point_triangle_feature(kind == 1, first, second);
        if (!seen.insert(feature).second) continue;
        found.push_back({{feature, first, second}, static_cast<Real>(found.size())});
    }
    return found;
}

}  // namespace

TEST_CASE("features found are put in order by counting as sorting puts them", "[unit]") {
    test::Random random(7);
    for (const std::size_t count : {0, 1, 7, 8, 9, 100, 511, 512, 513, 1000}) {
        CAPTURE(count);
        Column<FoundCandidate> found = random_features(random, count);
        std::vector<FoundCandidate> expected(found.begin(), found.end());
        std::ranges::sort(expected, {}, [](const FoundCandidate& f) { return f.candidate.feature; });
        sort_by_feature(found);
        REQUIRE(found.size() == count);
        for (std::size_t i = 0; i < count; ++i) {
            CHECK(found[i].candidate.feature == expected[i].candidate.feature);
            CHECK(found[i].candidate.second == expected[i].candidate.second);
            CHECK(found[i].asleep_until == expected[i].asleep_until);
        }
    }
}

TEST_CASE("of one kind alone as many are put in order as of three", "[unit]") {
    Column<FoundCandidate> found;
    for (Index i = static_cast<Index>(counted_at_most); i-- > 0;)
        found.push_back({{edge_edge_feature(i, 3), i, 3}, static_cast<Real>(i)});
    sort_by_feature(found);
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i].asleep_until == static_cast<Real>(i));
}

}  // namespace skerry::test::sort_found_test
