#include "components/handle.h"

#include <catch2/catch.hpp>
#include <random>
#include <vector>

using namespace skerry;

TEST_CASE("a default handle names nothing", "[unit]") {
    HandleMap<BodyHandle> map;
    REQUIRE(map.row(BodyHandle{}) == no_index);
    map.insert(0);
    REQUIRE(map.row(BodyHandle{}) == no_index);
}

TEST_CASE("a handle follows its row when earlier rows are erased", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle a = map.insert(0), b = map.insert(1), c = map.insert(2);
    map.erase(a);
    REQUIRE(map.row(b) == 0);
    REQUIRE(map.row(c) == 1);
    map.erase(c);
    REQUIRE(map.row(b) == 0);
}

TEST_CASE("a handle to an erased row is stale, also when its slot is used again", "[unit]") {
    HandleMap<BodyHandle> map;
    const BodyHandle old = map.insert(0);
    map.erase(old);
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
    map.erase(b);
    map.erase(a);
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
    std::vector<BodyHandle> rows, dead;  // the twin: rows[r] is the handle of row r
    for (int i = 0; i < 500; ++i) {
        if (rows.empty() || random() % 5 < 3) {
            rows.push_back(map.insert(static_cast<Index>(rows.size())));
        } else {
            const auto erased = rows.begin() + static_cast<std::ptrdiff_t>(random() % rows.size());
            map.erase(*erased);
            dead.push_back(*erased);
            rows.erase(erased);
        }
        for (std::size_t row = 0; row < rows.size(); ++row) REQUIRE(map.row(rows[row]) == static_cast<Index>(row));
    }
    for (const BodyHandle& handle : dead) REQUIRE(map.row(handle) == no_index);
}
