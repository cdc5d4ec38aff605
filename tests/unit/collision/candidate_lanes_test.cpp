// Eight candidates side by side against the scalar functions.
#include "systems/collision/narrow/candidate_lanes.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "systems/geometry/closest_points.h"
#include "tests/support/random.h"

namespace skerry::test::candidate_lanes_test {

namespace {

/// Nodes of eight candidates in arbitrary order. No two candidates share a node.
struct Eight {
    test::Random random{5};
    std::vector<Vec3> position;
    CandidateNodeLanes node;

    Eight() {
        for (std::size_t n = 0; n < 4 * candidate_lanes; ++n) position.push_back(random.vector());
        for (std::size_t lane = 0; lane < candidate_lanes; ++lane) {
            const auto at = [&](std::size_t k) { return static_cast<Index>((7 * lane + 11 * k) % position.size()); };
            set_lane(node, lane, {at(0), at(1), at(2), at(3)});
        }
    }
    FourPoints of(const std::vector<Vec3>& column, std::size_t lane) const {
        FourPoints four;
        for (std::size_t k = 0; k < 4; ++k) four[k] = column[static_cast<std::size_t>(node[k][lane])];
        return four;
    }
};

Real distance(FeaturePair kind, const FourPoints& x) {
    return std::sqrt(kind == FeaturePair::edge_edge
                         ? closest_points_of_segments(x[0], x[1], x[2], x[3]).distance_squared
                         : closest_point_on_triangle(x[0], x[1], x[2], x[3]).distance_squared);
}

}  // namespace

TEST_CASE("eight candidates are as far apart as one by one", "[unit]") {
    constexpr Real rounding = 1e-13;
    const Eight eight;
    for (const FeaturePair kind : {FeaturePair::point_triangle, FeaturePair::edge_edge}) {
        const auto distance_of = distances(kind, eight.position, eight.node);
        for (std::size_t lane = 0; lane < candidate_lanes; ++lane)
            CHECK(distance_of[lane] == Approx(distance(kind, eight.of(eight.position, lane))).epsilon(rounding));
    }
}

}  // namespace skerry::test::candidate_lanes_test
