#include "systems/geometry/time_of_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "systems/geometry/closest_points.h"
#include "tests/support/draws.h"
#include "tests/support/random.h"

namespace skerry::test::time_of_contact_test {

using test::Random;

namespace {

constexpr std::uint64_t seed = 41;

using Wide = long double;
using WideVector = Eigen::Matrix<Wide, 3, 1>;

FourPoints random_points(Random& random, Real scale) {
    return {scale * random.vector(), scale * random.vector(), scale * random.vector(), scale * random.vector()};
}

/// Slow reference in extended precision: the times at which the four points are coplanar (roots of a cubic, by
/// bisection between its extrema), and the first of them at which the features meet.
class Oracle {
public:
    Oracle(FeaturePair kind, const FourPoints& x, const FourPoints& d) : kind_(kind) {
        for (std::size_t i = 0; i < 4; ++i) {
            x_[i] = x[i].cast<Wide>();
            d_[i] = d[i].cast<Wide>();
        }
    }

    /// Time of the first contact as a fraction of the step; above 1 if there is none.
    Wide first_contact() const {
        const auto [c1, c2, c3] = derivative();
        std::vector<Wide> cuts{0, 1};
        const Wide discriminant = c2 * c2 - 4 * c1 * c3;
        if (c3 != 0 && discriminant >= 0)
            for (Wide sign : {-1, 1}) cuts.push_back((-c2 + sign * std::sqrt(discriminant)) / (2 * c3));
        else if (c2 != 0)
            cuts.push_back(-c1 / c2);
        std::erase_if(cuts, [](Wide t) { return !(t >= 0 && t <= 1); });
        std::sort(cuts.begin(), cuts.end());
        for (std::size_t i = 1; i < cuts.size(); ++i) {
            Wide low = cuts[i - 1], high = cuts[i];
            if (volume(low) * volume(high) > 0) continue;
            const bool rising = volume(high) > volume(low);
            for (int round = 0; round < 100; ++round) {
                const Wide middle = (low + high) / 2;
                (volume(middle) < 0) == rising ? low = middle : high = middle;
            }
            if (meet(high)) return high;
        }
        return 2;
    }

private:
    WideVector at(std::size_t i, Wide t) const { return x_[i] + t * d_[i]; }
    Wide volume(Wide t) const { return (at(1, t) - at(0, t)).cross(at(2, t) - at(0, t)).dot(at(3, t) - at(0, t)); }
    /// Derivative of the cubic, c1 + c2 t + c3 t^2, from four values of the cubic.
    std::array<Wide, 3> derivative() const {
        const Wide f0 = volume(0), f1 = volume(1), g0 = volume(-1), f2 = volume(2);
        const Wide b = (f1 + g0) / 2 - f0;
        const Wide a = (f2 - f0 - 4 * b - (f1 - g0)) / 6;
        const Wide c = (f1 - g0) / 2 - a;
        return {c, 2 * b, 3 * a};
    }
    /// For coplanar points: true if the features have a point in common.
    bool meet(Wide t) const {
        const std::array<WideVector, 4> x{at(0, t), at(1, t), at(2, t), at(3, t)};
        if (kind_ == FeaturePair::edge_edge)
            return separates(x[0], x[1], x[2], x[3]) && separates(x[2], x[3], x[0], x[1]);
        const WideVector normal = (x[2] - x[1]).cross(x[3] - x[1]);
        for (std::size_t k = 0; k < 3; ++k) {
            const WideVector &a = x[1 + k], &b = x[1 + (k + 1) % 3];
            if ((b - a).cross(x[0] - a).dot(normal) < 0) return false;
        }
        return true;
    }
    /// True if p and q lie on different sides of the line ab, or on it. All points are coplanar.
    static bool separates(const WideVector& a, const WideVector& b, const WideVector& p, const WideVector& q) {
        return (b - a).cross(p - a).dot((b - a).cross(q - a)) <= 0;
    }

    FeaturePair kind_;
    std::array<WideVector, 4> x_, d_;
};

Real distance_at(FeaturePair kind, const FourPoints& x, const FourPoints& d, Real t) {
    FourPoints y;
    for (std::size_t i = 0; i < 4; ++i) y[i] = x[i] + t * d[i];
    return std::sqrt(kind == FeaturePair::point_triangle
                         ? closest_point_on_triangle(y[0], y[1], y[2], y[3]).distance_squared
                         : closest_points_of_segments(y[0], y[1], y[2], y[3]).distance_squared);
}

/// Checks that a reported time is not later than the true one, and that the features are near each other then.
void check_against_oracle(FeaturePair kind, const FourPoints& x, const FourPoints& d, int& met) {
    const Wide truth = Oracle(kind, x, d).first_contact();
    const std::optional<Real> time = time_of_contact(kind, x, d);
    if (truth <= 1) {
        ++met;
        REQUIRE(time);
        REQUIRE(*time <= truth);
    }
    if (!time) return;
    REQUIRE(*time >= 0);
    REQUIRE(*time <= 1);
    REQUIRE(distance_at(kind, x, d, *time) <= contact_slack * distance_at(kind, x, d, 0));
}

}  // namespace

TEST_CASE("the time of contact is never later than the exact one, and then they are within the slack", "[unit]") {
    INFO("seed " << seed);
    Random random(seed);
    for (FeaturePair kind : {FeaturePair::point_triangle, FeaturePair::edge_edge}) {
        int met = 0, reported = 0;
        for (int trial = 0; trial < draws(20000); ++trial) {
            const FourPoints x = random_points(random, 1);
            // Half of the trials aim at the other feature, with some common motion; the others move at random.
            FourPoints d = random_points(random, 1);
            if (trial % 2) {
                const Real a = std::abs(random.number()), b = std::abs(random.number());
                const Vec3 aim = kind == FeaturePair::point_triangle
                                     ? Vec3(x[1] + a * (1 - b) * (x[2] - x[1]) + b * (x[3] - x[1]) - x[0])
                                     : Vec3(x[2] + a * (x[3] - x[2]) - x[0] - b * (x[1] - x[0]));
                const Vec3 common = 100 * random.vector();
                for (std::size_t i = 0; i < 4; ++i) d[i] = 0.1 * d[i] + common;
                d[0] += 2 * aim;
                if (kind == FeaturePair::edge_edge) d[1] += 2 * aim;
            }
            check_against_oracle(kind, x, d, met);
            reported += time_of_contact(kind, x, d).has_value();
        }
        CHECK(met > draws(5000));
        CHECK(reported - met > draws(100));  // near misses are reported, too
    }
}

TEST_CASE("features that stay further apart than the slack are never reported", "[unit]") {
    Random random(seed + 1);
    int far = 0;
    for (FeaturePair kind : {FeaturePair::point_triangle, FeaturePair::edge_edge})
        for (int trial = 0; trial < draws(2000); ++trial) {
            const FourPoints x = random_points(random, 1), d = random_points(random, 1);
            Real nearest = std::numeric_limits<Real>::infinity();
            for (int i = 0; i <= 200; ++i) nearest = std::min(nearest, distance_at(kind, x, d, i / 200.0));
            // Between two samples a distance changes by at most half of the approach in one interval.
            if (nearest - greatest_approach(kind, d) / 400 <= contact_slack * distance_at(kind, x, d, 0)) continue;
            ++far;
            REQUIRE_FALSE(time_of_contact(kind, x, d));
        }
    CHECK(far > draws(2000));
}

TEST_CASE("degenerate motions have the time of contact that they should", "[unit]") {
    const FourPoints triangle{Vec3(0.2, 0.2, 1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    const Vec3 none = Vec3::Zero(), down(0, 0, -2);
    const auto point_triangle = FeaturePair::point_triangle, edge_edge = FeaturePair::edge_edge;

    SECTION("without motion, or with common motion only, nothing meets") {
        CHECK_FALSE(time_of_contact(point_triangle, triangle, {none, none, none, none}));
        CHECK_FALSE(time_of_contact(point_triangle, triangle, {down, down, down, down}));
    }
    SECTION("what touches at the start meets at once, whatever moves") {
        FourPoints touching = triangle;
        touching[0] = Vec3(0.25, 0.25, 0);
        for (const Vec3& motion : {none, down, Vec3(-down)})
            CHECK(time_of_contact(point_triangle, touching, {motion, none, none, none}) == 0.0);
    }
    SECTION("a point that falls on a corner or an edge of the triangle, or beside it") {
        for (const Vec3& over : {Vec3(0, 0, 1), Vec3(0.5, 0, 1), Vec3(0.5, 0.5, 1), Vec3(1, 0, 1)}) {
            FourPoints x = triangle;
            x[0] = over;
            const auto time = time_of_contact(point_triangle, x, {down, none, none, none});
            REQUIRE(time);
            CHECK(*time <= 0.5);
            CHECK(*time >= 0.45);  // the tolerance is a tenth of the distance
        }
        FourPoints beside = triangle;
        beside[0] = Vec3(-0.2, 0.5, 1);  // passes at 0.2, above a tenth of the initial distance
        CHECK_FALSE(time_of_contact(point_triangle, beside, {down, none, none, none}));
    }
    SECTION("parallel edges, edges in one line and edges in one plane") {
        const FourPoints parallel{Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0.3, 0, 0), Vec3(1.3, 0, 0)};
        const auto meets = time_of_contact(edge_edge, parallel, {down, down, none, none});
        REQUIRE(meets);
        CHECK(*meets <= 0.5);
        CHECK(*meets >= 0.45);
        const FourPoints in_line{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0)};
        const Vec3 along(2, 0, 0);
        CHECK(time_of_contact(edge_edge, in_line, {along, along, none, none}).value_or(2) == Approx(0.45).margin(0.05));
        const FourPoints in_plane{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(0.5, 2, 0)};
        const Vec3 up(0, 2, 0);
        CHECK(time_of_contact(edge_edge, in_plane, {up, up, none, none}).value_or(2) == Approx(0.45).margin(0.05));
    }
    SECTION("features of no extent are points") {
        const FourPoints points{Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(0, 0, 0)};
        CHECK(time_of_contact(edge_edge, points, {down, down, none, none}).value_or(2) == Approx(0.45).margin(0.05));
        CHECK(
            time_of_contact(point_triangle, {Vec3(0, 0, 1), none, none, none}, {down, none, none, none}).value_or(2) ==
            Approx(0.45).margin(0.05));
    }
    SECTION("a long slide at a small distance is no contact") {
        FourPoints x = triangle;
        x[0] = Vec3(0.1, 0.1, 1e-3);
        CHECK_FALSE(time_of_contact(point_triangle, x, {Vec3(0.5, 0.2, 0), none, none, none}));
        x[0].z() = 1e-9;
        CHECK_FALSE(time_of_contact(point_triangle, x, {Vec3(0.5, 0.2, 0), none, none, none}));
        const FourPoints crossed{Vec3(-1, 0, 1e-9), Vec3(1, 0, 1e-9), Vec3(0, -1, 0), Vec3(0, 1, 0)};
        CHECK_FALSE(time_of_contact(edge_edge, crossed, {Vec3(0.5, 0.2, 0), Vec3(0.5, 0.2, 0), none, none}));
        // One end rises by more than the other descends.
        CHECK_FALSE(time_of_contact(edge_edge, crossed, {Vec3(0, 0, 0.5), Vec3(0, 0, 0.1), none, none}));
    }
}

TEST_CASE("features that keep a distance are not nearer before the time, and then they are near it", "[unit]") {
    INFO("seed " << seed);
    Random random(seed);
    constexpr int looks = 300;
    for (FeaturePair kind : {FeaturePair::point_triangle, FeaturePair::edge_edge}) {
        int met = 0, passed = 0;
        for (int trial = 0; trial < draws(1000); ++trial) {
            const FourPoints x = random_points(random, 1), d = random_points(random, 1);
            const Real start = distance_at(kind, x, d, 0);
            const ContactThreshold kept{start * 0.9 * std::abs(random.number()), trial % 2 ? 1e-3 * start : 1};
            const std::optional<Real> time = time_of_contact(kind, x, d, kept);
            for (int look = 0; look <= looks; ++look)
                REQUIRE(distance_at(kind, x, d, time.value_or(1) * look / looks) > kept.distance);
            ++(time ? met : passed);
            if (time)
                REQUIRE(distance_at(kind, x, d, *time) - kept.distance <=
                        std::min(contact_slack * (start - kept.distance), kept.near));
        }
        CHECK(met > draws(100));
        CHECK(passed > draws(100));
    }
}

}  // namespace skerry::test::time_of_contact_test
