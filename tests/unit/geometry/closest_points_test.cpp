#include "systems/geometry/closest_points.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/random.h"

namespace skerry::test::closest_points_test {

using test::Random;

namespace {

constexpr int samples = 60;

Real sampled_triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    Real best = std::numeric_limits<Real>::infinity();
    for (int i = 0; i <= samples; ++i)
        for (int j = 0; i + j <= samples; ++j) {
            const Real u = Real(i) / samples, v = Real(j) / samples;
            best = std::min(best, (p - (1 - u - v) * a - u * b - v * c).norm());
        }
    return best;
}

Real sampled_segment_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
    Real best = std::numeric_limits<Real>::infinity();
    for (int i = 0; i <= samples; ++i)
        for (int j = 0; j <= samples; ++j) {
            const Real s = Real(i) / samples, t = Real(j) / samples;
            best = std::min(best, (a0 + s * (a1 - a0) - b0 - t * (b1 - b0)).norm());
        }
    return best;
}

void check_consistent(const PointTriangle& found, const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Real scale = 1 + p.norm();
    for (Real w : found.weight) {
        CHECK(w >= -1e-12);
        CHECK(w <= 1 + 1e-12);
    }
    CHECK(found.weight[0] + found.weight[1] + found.weight[2] == Approx(1).epsilon(1e-12));
    CHECK((found.weight[0] * a + found.weight[1] * b + found.weight[2] * c - found.nearest).norm() <= 1e-12 * scale);
    CHECK(std::abs((p - found.nearest).squaredNorm() - found.distance_squared) <= 1e-14 * scale * scale);
}

}  // namespace

TEST_CASE("the nearest point of a triangle is no further than any sampled point of it", "[unit]") {
    Random random(1);
    for (int trial = 0; trial < 300; ++trial) {
        const Vec3 a = random.vector(), b = random.vector(), c = random.vector(), p = 2 * random.vector();
        const PointTriangle found = closest_point_on_triangle(p, a, b, c);
        check_consistent(found, p, a, b, c);
        const Real sampled = sampled_triangle_distance(p, a, b, c);
        const Real longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
        CHECK(std::sqrt(found.distance_squared) <= sampled + 1e-12);
        CHECK(std::sqrt(found.distance_squared) >= sampled - longest / samples);  // spacing of the samples
    }
}

TEST_CASE("each Voronoi region of a triangle is named, with zero weights outside of the feature", "[unit]") {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    struct Case {
        Vec3 p;
        TriangleRegion region;
        std::array<Real, 3> weight;
    };
    const Case cases[] = {
        {{0.25, 0.25, 0.5}, TriangleRegion::face, {0.5, 0.25, 0.25}},
        {{0.5, -1, 0.5}, TriangleRegion::edge01, {0.5, 0.5, 0}},
        {{1, 1, -0.5}, TriangleRegion::edge12, {0, 0.5, 0.5}},
        {{-1, 0.5, 0.5}, TriangleRegion::edge20, {0.5, 0, 0.5}},
        {{-1, -1, 0.3}, TriangleRegion::vertex0, {1, 0, 0}},
        {{2, -0.5, 0.3}, TriangleRegion::vertex1, {0, 1, 0}},
        {{-0.5, 2, 0.3}, TriangleRegion::vertex2, {0, 0, 1}},
    };
    for (const Case& test : cases) {
        const PointTriangle found = closest_point_on_triangle(test.p, a, b, c);
        CHECK(found.region == test.region);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(found.weight[k] == Approx(test.weight[k]).margin(1e-15));
            if (test.weight[k] == 0) CHECK(found.weight[k] == 0);  // exactly: such a node connects no regions
        }
    }
}

TEST_CASE("beside an edge of a triangle no weight is below zero", "[unit]") {
    Random random(7);
    int rounded = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const Vec3 a = random.vector(), b = random.vector(), c = random.vector(), normal = (b - a).cross(c - a);
        const Real s = 0.5 * (1 + random.number()), inside = 1e-16 * (1 + random.number());
        const Vec3 p = a + s * (b - a) + inside * (c - a) + random.number() * normal;
        const std::array<Vec3, 3> corner{a, b, c};
        const std::size_t turn = static_cast<std::size_t>(trial % 3);
        const PointTriangle found =
            closest_point_on_triangle(p, corner[turn], corner[(turn + 1) % 3], corner[(turn + 2) % 3]);
        for (const Real weight : found.weight) {
            REQUIRE(weight >= 0);
            REQUIRE(weight <= 1);
        }
        rounded +=
            found.region == TriangleRegion::face && *std::min_element(found.weight.begin(), found.weight.end()) == 0;
    }
    CHECK(rounded > 100);
}

TEST_CASE("a point in the plane of a triangle, on its edge or on its vertex is at distance 0", "[unit]") {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    for (const Vec3& p : {Vec3(0.3, 0.3, 0), Vec3(0.5, 0, 0), Vec3(0.5, 0.5, 0), a, b, c})
        CHECK(closest_point_on_triangle(p, a, b, c).distance_squared <= 1e-32);
}

TEST_CASE("a triangle without area is its longest edge, without length a point", "[unit]") {
    Random random(2);
    for (int trial = 0; trial < 100; ++trial) {
        const Vec3 a = random.vector(), d = random.vector(), p = 2 * random.vector();
        std::array<Vec3, 3> corner{a, a + d, a + 0.4 * d};
        std::rotate(corner.begin(), corner.begin() + trial % 3, corner.end());
        const PointTriangle found = closest_point_on_triangle(p, corner[0], corner[1], corner[2]);
        check_consistent(found, p, corner[0], corner[1], corner[2]);
        const Real s = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        CHECK(found.distance_squared == Approx((p - a - s * d).squaredNorm()).epsilon(1e-10));
        CHECK(found.region != TriangleRegion::face);

        const PointTriangle point = closest_point_on_triangle(p, a, a, a);
        CHECK(point.distance_squared == Approx((p - a).squaredNorm()));
        CHECK(point.region >= TriangleRegion::vertex0);
    }
}

TEST_CASE("slivers give the distance that a height of theirs can be off", "[unit]") {
    Random random(3);
    for (Real height : {1e-3, 1e-5, 1e-6, 1e-7, 1e-9}) {
        for (int trial = 0; trial < 50; ++trial) {
            const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.5 + 0.4 * random.number(), height, 0), p = random.vector();
            const Real edge = std::sqrt((p - Vec3(std::clamp(p[0], 0.0, 1.0), 0, 0)).squaredNorm());
            CHECK(std::abs(std::sqrt(closest_point_on_triangle(p, a, b, c).distance_squared) - edge) <=
                  1.01 * height + 1e-12);
        }
    }
}

TEST_CASE("nearest points of segments are no further than any sampled pair", "[unit]") {
    Random random(4);
    for (int trial = 0; trial < 300; ++trial) {
        const Vec3 a0 = random.vector(), a1 = random.vector(), b0 = random.vector(), b1 = random.vector();
        const SegmentSegment found = closest_points_of_segments(a0, a1, b0, b1);
        CHECK(found.s >= 0);
        CHECK(found.s <= 1);
        CHECK(found.t >= 0);
        CHECK(found.t <= 1);
        CHECK((a0 + found.s * (a1 - a0) - found.on_first).norm() <= 1e-14);
        CHECK((b0 + found.t * (b1 - b0) - found.on_second).norm() <= 1e-14);
        const Real distance = std::sqrt(found.distance_squared), sampled = sampled_segment_distance(a0, a1, b0, b1);
        CHECK(distance == Approx((found.on_first - found.on_second).norm()));
        CHECK(distance <= sampled + 1e-12);
        CHECK(distance >= sampled - ((a1 - a0).norm() + (b1 - b0).norm()) / samples);
        CHECK(found.interior == (found.s > 0 && found.s < 1 && found.t > 0 && found.t < 1));
        if (found.interior) {
            CHECK(std::abs((found.on_first - found.on_second).dot(a1 - a0)) <= 1e-10);
            CHECK(std::abs((found.on_first - found.on_second).dot(b1 - b0)) <= 1e-10);
        }
    }
}

TEST_CASE("parallel, collinear and zero-length segments have a distance and no interior", "[unit]") {
    const Vec3 x(1, 0, 0), y(0, 1, 0), o(0, 0, 0);
    const auto distance = [](const SegmentSegment& found) { return std::sqrt(found.distance_squared); };
    SegmentSegment found = closest_points_of_segments(o, x, y, y + x);
    CHECK(distance(found) == Approx(1));
    CHECK_FALSE(found.interior);
    found = closest_points_of_segments(o, x, y + 2 * x, y + 3 * x);
    CHECK(distance(found) == Approx(std::sqrt(2.0)));
    found = closest_points_of_segments(o, x, 3 * x, 2 * x);
    CHECK(distance(found) == Approx(1));
    CHECK_FALSE(found.interior);
    found = closest_points_of_segments(o, o, y - x, y + x);
    CHECK(distance(found) == Approx(1));
    found = closest_points_of_segments(y - x, y + x, o, o);
    CHECK(distance(found) == Approx(1));
    CHECK_FALSE(found.interior);
    found = closest_points_of_segments(o, o, y, y);
    CHECK(distance(found) == Approx(1));
    CHECK_FALSE(found.interior);
    // An angle of 1e-4 counts as parallel. The distance is right nevertheless: the segments cross in the middle.
    found = closest_points_of_segments(-x, x, Vec3(-1, -1e-4, 0.5), Vec3(1, 1e-4, 0.5));
    CHECK(distance(found) == Approx(0.5).epsilon(1e-12));
    CHECK_FALSE(found.interior);
}

TEST_CASE("segments that touch end to middle are at distance 0", "[unit]") {
    const SegmentSegment found = closest_points_of_segments({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0});
    CHECK(found.distance_squared == 0);
    CHECK_FALSE(found.interior);
}

TEST_CASE("numbers that are not finite give a distance that is not a number", "[unit]") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Vec3 bad(nan, 0, 0), a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    CHECK_FALSE(closest_point_on_triangle(bad, a, b, c).distance_squared >= 0);
    CHECK_FALSE(closest_points_of_segments(bad, a, b, c).distance_squared >= 0);
}

}  // namespace skerry::test::closest_points_test
