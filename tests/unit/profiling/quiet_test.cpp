#include "profiling/scaling/quiet.h"

#include <catch2/catch.hpp>
#include <stdexcept>

namespace skerry::test::quiet_test {

using namespace skerry::profiling;

TEST_CASE("a fifth of the values does not exceed their lower fifth", "[unit]") {
    CHECK(lower_fifth({7}) == 7);
    CHECK(lower_fifth({9, 1, 8, 7}) == 1);
    CHECK(lower_fifth({5, 4, 3, 2, 1, 10}) == 2);
    CHECK(lower_fifth({11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1}) == 3);
}

TEST_CASE("a third of the rounds counts, that which was disturbed least", "[unit]") {
    const auto kept = least_disturbed({{0.9, {}}, {0.1, {}}, {0.5, {}}, {0.2, {}}});
    REQUIRE(kept.size() == 2);
    CHECK(kept[0].others == 0.1);
    CHECK(kept[1].others == 0.2);
    CHECK(least_disturbed({{2, {}}}).size() == 1);
}

TEST_CASE("each step counts as in a round in which it was not disturbed", "[unit]") {
    const std::vector<Round> rounds{{0, {{1, 20}, {1, 1}}}, {0, {{10, 2}, {1, 1}}}};
    CHECK(undisturbed_sum(rounds, 0) == 3);
    CHECK(undisturbed_sum(rounds, 1) == 2);
    CHECK_THROWS_AS(undisturbed_sum({{0, {{1, 2}}}, {0, {{1}}}}, 0), std::runtime_error);
}

}  // namespace skerry::test::quiet_test
