#include "components/box_grid.h"

#include <catch2/catch.hpp>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace skerry::test::box_grid_test {

namespace {

using Visits = std::map<std::pair<Index, Index>, int>;  // by pair of rows, the smaller first

bool meet(const Aabb& a, const Aabb& b) {
    return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

std::vector<Index> all_rows(const std::vector<Aabb>& boxes) {
    std::vector<Index> rows;
    for (std::size_t i = 0; i < boxes.size(); ++i) rows.push_back(static_cast<Index>(i));
    return rows;
}

Visits visits_of(const BoxGrid& grid, const std::vector<Index>& rows) {
    Visits visits;
    for (const Index row : rows)
        grid.for_each_near(row, [&](Index other) { ++visits[{std::min(row, other), std::max(row, other)}]; });
    return visits;
}

/// Checks that pairs of rows are visited at most once, and overlapping pairs always. Returns the number of these.
std::size_t check_visits(const std::vector<Aabb>& boxes, const std::vector<Index>& rows, const Visits& visits) {
    for (const auto& [pair, count] : visits) {
        CHECK(count == 1);
        CHECK(pair.first != pair.second);
    }
    std::size_t meeting = 0;
    for (const Index a : rows)
        for (const Index b : rows) {
            if (a >= b || !meet(boxes[static_cast<std::size_t>(a)], boxes[static_cast<std::size_t>(b)])) continue;
            ++meeting;
            CHECK(visits.count({a, b}) == 1);
        }
    return meeting;
}

}  // namespace

TEST_CASE("of boxes of all sizes each pair that meets is reported once", "[unit]") {
    test::Random random(5);
    BoxGrid grid;  // one grid for all trials: nothing of earlier boxes may remain
    std::size_t meeting = 0;
    for (const int count : {0, 1, 2, 40, 400})
        for (const Real offset : {0.0, -3e3, 1e15}) {
            CAPTURE(count, offset);
            std::vector<Aabb> boxes;
            for (int i = 0; i < count; ++i) {
                const Vec3 middle = 2 * random.vector() + Vec3(offset, 0, -offset);
                const Vec3 half = std::pow(10, 3 * random.number() - 2.5) * random.vector().cwiseAbs();
                boxes.push_back({middle - half, middle + half});
            }
            const std::vector<Index> rows = all_rows(boxes);
            grid.build(boxes, rows);
            meeting += check_visits(boxes, rows, visits_of(grid, rows));
        }
    CHECK(meeting > 1000);
}

TEST_CASE("boxes that share a face, an edge, a corner or a point meet", "[unit]") {
    std::vector<Aabb> boxes;
    for (int i = 0; i < 125; ++i) {
        const Vec3 corner(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);  // on the borders of cells
        boxes.push_back({corner, corner + Vec3::Ones()});
        boxes.push_back({corner, corner});
    }
    const std::vector<Index> rows = all_rows(boxes);
    BoxGrid grid;
    grid.build(boxes, rows);
    check_visits(boxes, rows, visits_of(grid, rows));
}

TEST_CASE("omitted boxes are not reported", "[unit]") {
    const std::vector<Aabb> boxes(6, {Vec3::Zero(), Vec3::Ones()});
    const std::vector<Index> rows{1, 3, 4};
    BoxGrid grid;
    grid.build(boxes, rows);
    CHECK(visits_of(grid, rows) == Visits{{{1, 3}, 1}, {{1, 4}, 1}, {{3, 4}, 1}});
}

TEST_CASE("of boxes as large as their distance few pairs are reported that do not meet", "[unit]") {
    std::vector<Aabb> boxes;
    for (int x = 0; x < 12; ++x)
        for (int y = 0; y < 12; ++y)
            for (int z = 0; z < 12; ++z) {
                const Vec3 corner = 0.7 * Vec3(x, y, z);
                boxes.push_back({corner, corner + Vec3::Constant(0.71)});
            }
    const std::vector<Index> rows = all_rows(boxes);
    BoxGrid grid;
    grid.build(boxes, rows);
    CHECK(visits_of(grid, rows).size() < 100 * boxes.size());  // all pairs: 864 per box
}

}  // namespace skerry::test::box_grid_test
