#include "components/ragged.h"

#include <catch2/catch.hpp>
#include <vector>

namespace skerry::test::ragged_test {

namespace {

Ragged<int> rows(const std::vector<std::vector<int>>& content) {
    Ragged<int> ragged;
    ragged.offset.push_back(0);
    for (const auto& row : content) {
        for (int item : row) ragged.item.push_back(item);
        ragged.offset.push_back(static_cast<Index>(ragged.item.size()));
    }
    return ragged;
}

}  // namespace

TEST_CASE("a ragged without offsets has no rows, and one with a single offset neither", "[unit]") {
    REQUIRE(Ragged<int>().size() == 0);
    REQUIRE(Ragged<int>().view().size() == 0);
    REQUIRE(rows({}).size() == 0);
}

TEST_CASE("rows of a ragged have their own lengths, empty ones too", "[unit]") {
    const Ragged<int> ragged = rows({{1, 2}, {}, {3}, {}});
    const RaggedView<int> view = ragged.view();
    REQUIRE(ragged.size() == 4);
    REQUIRE(view.size() == 4);
    REQUIRE(std::vector<int>(view[0].begin(), view[0].end()) == std::vector<int>{1, 2});
    REQUIRE(ragged[1].empty());
    REQUIRE(view[2].size() == 1);
    REQUIRE(view[2][0] == 3);
    REQUIRE(ragged[3].empty());
}

TEST_CASE("a cleared ragged has no rows", "[unit]") {
    Ragged<int> ragged = rows({{1}, {2}});
    ragged.clear();
    REQUIRE(ragged.size() == 0);
}

}  // namespace skerry::test::ragged_test
