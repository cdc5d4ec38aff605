// Distances in eight lanes against the scalar functions.
#include "systems/geometry/closest_lanes.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "systems/geometry/closest_points.h"
#include "tests/support/random.h"

namespace skerry::test::closest_lanes_test {

using test::Random;

namespace {

constexpr std::size_t lanes = element_lanes;
using Points = std::array<Vec3, lanes>;

LaneVec3<Real8> loaded(const Points& points) {
    LaneVec3<Real8> all;
    for (std::size_t l = 0; l < lanes; ++l) {
        all.x[l] = points[l].x();
        all.y[l] = points[l].y();
        all.z[l] = points[l].z();
    }
    return all;
}

/// Four points per lane, of every kind: far and near, flat, short, parallel, touching.
std::array<Points, 4> random_features(Random& random) {
    std::array<Points, 4> of;
    for (std::size_t l = 0; l < lanes; ++l) {
        for (Points& points : of) points[l] = random.vector();
        const Real kind = random.number();
        if (kind < -0.8)
            of[3][l] = of[2][l] + 1e-9 * random.vector();  // a flat triangle, a point
        else if (kind < -0.6)
            of[3][l] = of[2][l] + (of[1][l] - of[0][l]);  // parallel
        else if (kind < -0.5)
            of[2][l] = of[0][l];  // touching
        else if (kind < -0.4)
            of[1][l] = of[2][l] = of[3][l];  // three equal points
        else if (kind < -0.2)
            of[3][l] = of[1][l] + 0.5 * (of[2][l] - of[1][l]);  // three points on a line
        else if (kind < 0)
            of[0][l] = (of[1][l] + of[2][l] + of[3][l]) / 3;  // in the plane
        else if (kind < 0.2)
            for (Points& points : of) points[l] *= 1e-3;  // small
    }
    return of;
}

}  // namespace

TEST_CASE("eight distances of points and triangles are those of each alone", "[unit]") {
    Random random(11);
    for (int trial = 0; trial < 2000; ++trial) {
        const std::array<Points, 4> x = random_features(random);
        const auto found = point_triangle_distance(loaded(x[0]), loaded(x[1]), loaded(x[2]), loaded(x[3]));
        for (std::size_t l = 0; l < lanes; ++l) {
            const PointTriangle expected = closest_point_on_triangle(x[0][l], x[1][l], x[2][l], x[3][l]);
            const Vec3 normal = (x[2][l] - x[1][l]).cross(x[3][l] - x[1][l]);
            const Real distance = std::sqrt(found.distance_squared[l]);
            INFO("trial " << trial << " lane " << l);
            // The scalar function replaces a triangle with a height below 1e-6 of its length by its longest edge.
            CHECK(distance == Approx(std::sqrt(expected.distance_squared)).margin(4e-6));
            CHECK(distance <= std::sqrt(expected.distance_squared) + 1e-12);
            CHECK(found.scaled_height[l] == Approx(normal.dot(x[0][l] - x[1][l])).margin(1e-12));
        }
    }
}

TEST_CASE("eight distances of triangles that are not flat agree to rounding", "[unit]") {
    Random random(12);
    for (int trial = 0; trial < 2000; ++trial) {
        std::array<Points, 4> x;
        for (Points& points : x)
            for (Vec3& point : points) point = random.vector();
        const auto found = point_triangle_distance(loaded(x[0]), loaded(x[1]), loaded(x[2]), loaded(x[3]));
        for (std::size_t l = 0; l < lanes; ++l)
            CHECK(std::sqrt(found.distance_squared[l]) ==
                  Approx(std::sqrt(closest_point_on_triangle(x[0][l], x[1][l], x[2][l], x[3][l]).distance_squared))
                      .margin(1e-10));
    }
}

TEST_CASE("eight distances of segments are those of each alone", "[unit]") {
    Random random(13);
    for (int trial = 0; trial < 2000; ++trial) {
        const std::array<Points, 4> x = random_features(random);
        const Real8 found = segment_distance_squared(loaded(x[0]), loaded(x[1]), loaded(x[2]), loaded(x[3]));
        for (std::size_t l = 0; l < lanes; ++l) {
            const SegmentSegment expected = closest_points_of_segments(x[0][l], x[1][l], x[2][l], x[3][l]);
            INFO("trial " << trial << " lane " << l);
            CHECK(std::sqrt(found[l]) == Approx(std::sqrt(expected.distance_squared)).margin(1e-10));
        }
    }
}

TEST_CASE("a position that is not a number makes its lane's distance none, and no other", "[unit]") {
    Random random(14);
    for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()})
        for (std::size_t point = 0; point < 4; ++point) {
            std::array<Points, 4> x;
            for (Points& points : x)
                for (Vec3& of_lane : points) of_lane = random.vector();
            x[point][3].y() = bad;
            const Real8 triangles =
                point_triangle_distance(loaded(x[0]), loaded(x[1]), loaded(x[2]), loaded(x[3])).distance_squared;
            const Real8 segments = segment_distance_squared(loaded(x[0]), loaded(x[1]), loaded(x[2]), loaded(x[3]));
            for (std::size_t l = 0; l < lanes; ++l) {
                INFO("point " << point << " lane " << l);
                CHECK(std::isfinite(triangles[l]) == (l != 3));
                CHECK(std::isfinite(segments[l]) == (l != 3));
            }
        }
}

}  // namespace skerry::test::closest_lanes_test
