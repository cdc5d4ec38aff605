// Values that change over time.
#include "components/key_lists.h"

#include <catch2/catch.hpp>
#include <vector>

namespace skerry::test::key_lists_test {

namespace {

const std::vector<TimeKey> ramp{{1, 2}, {3, 6}, {4, 6}};

TEST_CASE("a list of keys is linear between keys and constant outside") {
    CHECK(value_at(ramp, 0) == 2);
    CHECK(value_at(ramp, 1) == 2);
    CHECK(value_at(ramp, 2) == 4);
    CHECK(value_at(ramp, 3.5) == 6);
    CHECK(value_at(ramp, 9) == 6);
    CHECK(value_at(std::vector<TimeKey>{{5, 7}}, 0) == 7);
}

TEST_CASE("the mean of a list of keys is its exact integral") {
    CHECK(mean_value(ramp, 0, 1) == 2);
    CHECK(mean_value(ramp, 1, 1) == 3);
    // 2 over one second, the ramp from 2 to 6 over two, 6 over two
    CHECK(mean_value(ramp, 0, 5) == (2 * 1 + 4 * 2 + 6 * 2) / 5.0);
}

TEST_CASE("a list of keys changes only where two values differ") {
    CHECK_FALSE(changes(ramp, 0, 1));
    CHECK(changes(ramp, 0, 1.5));
    CHECK_FALSE(changes(ramp, 3, 2));
    // a peak between two equal values
    CHECK(changes(std::vector<TimeKey>{{0, 1}, {1, 2}, {2, 1}}, 0, 2));
}

TEST_CASE("lists of keys in a table can be replaced and erased") {
    Column<Range> range;
    Column<TimeKey> key;
    range.resize(3);
    set_keys(range, key, 0, ramp);
    set_keys(range, key, 1, std::vector<TimeKey>{{0, 1}});
    set_keys(range, key, 2, std::vector<TimeKey>{{0, 8}, {1, 9}});
    const auto list = [&](std::size_t row) {
        const std::span<const TimeKey> keys = rows_of(std::span<const TimeKey>(key.span()), range[row]);
        return std::vector<TimeKey>(keys.begin(), keys.end());
    };
    set_keys(range, key, 0, std::vector<TimeKey>{{2, 3}});
    CHECK(list(0) == std::vector<TimeKey>{{2, 3}});
    CHECK(list(1) == std::vector<TimeKey>{{0, 1}});
    CHECK(list(2) == std::vector<TimeKey>{{0, 8}, {1, 9}});
    erase_keys(range, key, 1);
    CHECK(list(1).empty());
    CHECK(list(0) == std::vector<TimeKey>{{2, 3}});
    CHECK(list(2) == std::vector<TimeKey>{{0, 8}, {1, 9}});
    CHECK(key.size() == 3);
}

}  // namespace

}  // namespace skerry::test::key_lists_test
