#include "components/handle.h"

#include <catch2/catch.hpp>
#include <random>
#include <vector>

namespace skerry::test::handle_test {

namespace {

/// Removes a handle, and its row from `count` rows.
void erase(HandleMap<BodyHandle>& map, BodyHandle handle, std::size_t count) {
    const Index row = map.row(handle);
    std::vector<Index> row_now;
    for (Index r = 0; r < static_cast<Index>(count); ++r) row_now.push_back(r == row ? no_index : r - (r > row));
    map.forget(handle);
    map.rows_moved(row_now);
}

}  // namespace

TEST_CASE("a default handle names nothing", "[unit]") {
    HandleMap<BodyHandle> map;
    REQUIRE(map.row(BodyHandle{}) == no_index);
    map.insert(0);
    REQUIRE(map.row(BodyHandle{}) == no_index);
}

TEST_CASE("a handle follows its row when earlier rows are erased", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle a = map.insert(0), b = map.insert(1), c = map.insert(2);
    erase(map, a, 3);
    REQUIRE(map.row(b) == 0);
    REQUIRE(map.row(c) == 1);
    erase(map, c, 2);
    REQUIRE(map.row(b) == 0);
}

TEST_CASE("a forgotten handle is stale before its row goes, and others keep their rows until then", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle a = map.insert(0), b = map.insert(1), c = map.insert(2);
    map.forget(a);
    map.forget(b);
    REQUIRE(map.row(a) == no_index);
    REQUIRE(map.row(c) == 2);
    const BodyHandle d = map.insert(3);
    REQUIRE(d.slot == a.slot);
    map.rows_moved(std::vector<Index>{no_index, no_index, 0, 1});
    REQUIRE(map.row(c) == 0);
    REQUIRE(map.row(d) == 1);
    REQUIRE(map.row(a) == no_index);
}

TEST_CASE("a handle to an erased row is stale, also when its slot is used again", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle old = map.insert(0);
    erase(map, old, 1);
    REQUIRE(map.row(old) == no_index);
    const BodyHandle fresh = map.insert(0);
    REQUIRE(fresh.slot == old.slot);
    REQUIRE(fresh != old);
    REQUIRE(map.row(old) == no_index);
    REQUIRE(map.row(fresh) == 0);
    REQUIRE(map.handle_of_slot(fresh.slot) == fresh);
}

TEST_CASE("freed slots are used again, the lowest first", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle a = map.insert(0), b = map.insert(1), c = map.insert(2);
    erase(map, b, 3);
    erase(map, a, 2);
    REQUIRE(map.insert(1).slot == a.slot);
    REQUIRE(map.insert(2).slot == b.slot);
    REQUIRE(map.insert(3).slot == 3);
    REQUIRE(map.row(c) == 0);
}

TEST_CASE("handles agree with a plain list of rows over random insertions and erasures", "[unit]") {
    const unsigned seed = 7;
    CAPTURE(seed);
    std::mt19937 random(seed);
    HandleMap<BodyHandle> map;
    std::vector<BodyHandle> rows, dead;  // reference: rows[r] is the handle of row r
    for (int i = 0; i < 500; ++i) {
        if (rows.empty() || random() % 5 < 3) {
            rows.push_back(map.insert(static_cast<Index>(rows.size())));
        } else {
            const auto erased = rows.begin() + static_cast<std::ptrdiff_t>(random() % rows.size());
            erase(map, *erased, rows.size());
            dead.push_back(*erased);
            rows.erase(erased);
        }
        for (std::size_t row = 0; row < rows.size(); ++row) REQUIRE(map.row(rows[row]) == static_cast<Index>(row));
    }
    for (const BodyHandle& handle : dead) REQUIRE(map.row(handle) == no_index);
}

}  // namespace skerry::test::handle_test
