#include "systems/collision/narrow/collider_distance.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/collision_world.h"
#include "tests/support/draws.h"

namespace skerry::test::collider_distance_test {

namespace {

constexpr Real pi = 3.14159265358979323846;

struct Named {
    const char* name;
    ColliderGeometry geometry;
};

const Named shapes[] = {
    {"plane", {ColliderShape::plane, Vec3::Zero()}},        {"sphere", {ColliderShape::sphere, {0.6, 0, 0}}},
    {"box", {ColliderShape::box, {0.3, 0.5, 0.8}}},         {"capsule", {ColliderShape::capsule, {0.3, 0.4, 0}}},
    {"cylinder", {ColliderShape::cylinder, {0.5, 0.4, 0}}}, {"flat cylinder", {ColliderShape::cylinder, {0.7, 0.1, 0}}},
    {"bucket", {ColliderShape::bucket, {0.5, 0.6, 0.1}}},   {"thick bucket", {ColliderShape::bucket, {0.3, 0.3, 0.4}}},
};

/// True if p is inside the solid, by the definition of the shape.
bool is_inside(const ColliderGeometry& g, const Vec3& p) {
    const Vec3& s = g.size;
    const Real r = std::hypot(p[0], p[1]);
    switch (g.shape) {
        case ColliderShape::plane:
            return p[2] < 0;
        case ColliderShape::sphere:
            return p.norm() < s[0];
        case ColliderShape::box:
            return (p.cwiseAbs().array() < s.array()).all();
        case ColliderShape::capsule:
            return (p - Vec3(0, 0, std::clamp(p[2], -s[1], s[1]))).norm() < s[0];
        case ColliderShape::cylinder:
            return r < s[0] && std::abs(p[2]) < s[1];
        case ColliderShape::bucket:
            return (r < s[0] + s[2] && p[2] > -s[2] && p[2] < 0) ||
                   (r > s[0] && r < s[0] + s[2] && p[2] > -s[2] && p[2] < s[1]);
        case ColliderShape::mesh:
            break;
    }
    return false;
}

/// Points of the surface, about `step` apart.
std::vector<Vec3> sample_surface(const ColliderGeometry& g, Real step) {
    const Vec3& s = g.size;
    std::vector<Vec3> points;
    // The outline lies in the half plane (r, z) and is rotated about z; box and plane are separate.
    std::vector<std::array<Real, 2>> outline;
    const auto line = [&](Real r0, Real z0, Real r1, Real z1) {
        const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(r1 - r0, z1 - z0) / step)));
        for (int i = 0; i <= n; ++i) outline.push_back({r0 + (r1 - r0) * i / n, z0 + (z1 - z0) * i / n});
    };
    const auto arc = [&](Real radius, Real z, Real from, Real to) {
        const int n = std::max(1, static_cast<int>(std::ceil(radius * std::abs(to - from) / step)));
        for (int i = 0; i <= n; ++i) {
            const Real a = from + (to - from) * i / n;
            outline.push_back({radius * std::cos(a), z + radius * std::sin(a)});
        }
    };
    switch (g.shape) {
        case ColliderShape::plane:
            for (Real x = -2; x <= 2; x += step)
                for (Real y = -2; y <= 2; y += step) points.push_back({x, y, 0});
            return points;
        case ColliderShape::box:
            for (int axis = 0; axis < 3; ++axis) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const int nu = static_cast<int>(2 * s[u] / step) + 1, nv = static_cast<int>(2 * s[v] / step) + 1;
                for (int i = 0; i <= nu; ++i)
                    for (int j = 0; j <= nv; ++j)
                        for (Real side : {-1.0, 1.0}) {
                            Vec3 p;
                            p[axis] = side * s[axis];
                            p[u] = s[u] * (2.0 * i / nu - 1);
                            p[v] = s[v] * (2.0 * j / nv - 1);
                            points.push_back(p);
                        }
            }
            return points;
        case ColliderShape::sphere:
            arc(s[0], 0, -pi / 2, pi / 2);
            break;
        case ColliderShape::capsule:
            arc(s[0], -s[1], -pi / 2, 0);
            line(s[0], -s[1], s[0], s[1]);
            arc(s[0], s[1], 0, pi / 2);
            break;
        case ColliderShape::cylinder:
            line(0, -s[1], s[0], -s[1]);
            line(s[0], -s[1], s[0], s[1]);
            line(s[0], s[1], 0, s[1]);
            break;
        case ColliderShape::bucket:
            line(0, 0, s[0], 0);
            line(s[0], 0, s[0], s[1]);
            line(s[0], s[1], s[0] + s[2], s[1]);
            line(s[0] + s[2], s[1], s[0] + s[2], -s[2]);
            line(s[0] + s[2], -s[2], 0, -s[2]);
            break;
        case ColliderShape::mesh:
            break;
    }
    for (const auto& [r, z] : outline) {
        const int n = std::max(1, static_cast<int>(std::ceil(2 * pi * r / step)));
        for (int i = 0; i < n; ++i) points.push_back({r * std::cos(2 * pi * i / n), r * std::sin(2 * pi * i / n), z});
    }
    return points;
}

}  // namespace

TEST_CASE("the distance to every shape agrees with its sampled surface, inside and outside", "[unit]") {
    constexpr Real step = 0.02;
    test::Random random(11);
    for (const Named& shape : shapes) {
        INFO(shape.name);
        const RigidMotion motion = test::CollisionWorld::at(random.vector(), random.rotation());
        const std::vector<Vec3> surface = sample_surface(shape.geometry, step);
        for (int trial = 0; trial < draws(300); ++trial) {
            const Vec3 local = 1.2 * random.vector();
            const SurfacePoint found =
                distance_to_collider(shape.geometry, motion, motion.position + motion.rotation * local);
            Real sampled = 1e300;
            for (const Vec3& x : surface) sampled = std::min(sampled, (x - local).norm());
            CHECK((found.distance < 0) == is_inside(shape.geometry, local));
            CHECK(std::abs(found.distance) <= sampled + 1e-9);
            CHECK(std::abs(found.distance) >= sampled - step);  // no point of the surface is further from a sample
        }
    }
}

TEST_CASE("normal and nearest point belong to the distance, and its gradient is the normal", "[unit]") {
    constexpr Real h = 1e-6;
    test::Random random(12);
    for (const Named& shape : shapes) {
        INFO(shape.name);
        const RigidMotion motion = test::CollisionWorld::at(random.vector(), random.rotation());
        int compared = 0;
        for (int trial = 0; trial < draws(300); ++trial) {
            const Vec3 p = motion.position + motion.rotation * Vec3(1.2 * random.vector());
            const SurfacePoint found = distance_to_collider(shape.geometry, motion, p);
            CHECK(found.normal.norm() == Approx(1).epsilon(1e-12));
            CHECK((found.point + found.distance * found.normal - p).norm() <= 1e-12);
            CHECK(std::abs(distance_to_collider(shape.geometry, motion, found.point).distance) <= 1e-12);
            Vec3 gradient;
            for (int i = 0; i < 3; ++i) {
                const Vec3 e = h * Vec3::Unit(i);
                gradient[i] = (distance_to_collider(shape.geometry, motion, p + e).distance -
                               distance_to_collider(shape.geometry, motion, p - e).distance) /
                              (2 * h);
            }
            // Near a medial axis the differences straddle it and give no gradient.
            if (std::abs(gradient.norm() - 1) > 1e-6) continue;
            ++compared;
            // tolerance: curvature at points near the axis of a body of revolution
            CHECK((gradient - found.normal).norm() <= 1e-4);
        }
        CHECK(compared > draws(290));
    }
}

TEST_CASE("on a medial axis one nearest point is chosen, always the same", "[unit]") {
    const RigidMotion motion = test::CollisionWorld::at(Vec3::Zero());
    struct Case {
        ColliderGeometry geometry;
        Vec3 point;
        Real distance;
    };
    const Case cases[] = {
        {{ColliderShape::sphere, {0.6, 0, 0}}, {0, 0, 0}, -0.6},
        {{ColliderShape::box, {0.5, 0.5, 0.5}}, {0, 0, 0}, -0.5},
        {{ColliderShape::box, {0.5, 0.5, 0.8}}, {0.2, 0.2, 0}, -0.3},
        {{ColliderShape::capsule, {0.3, 0.4, 0}}, {0, 0, 0.1}, -0.3},
        {{ColliderShape::cylinder, {0.5, 0.5, 0}}, {0, 0, 0}, -0.5},
        {{ColliderShape::bucket, {0.5, 1, 0.1}}, {0, 0, 0.5}, 0.5},
        {{ColliderShape::bucket, {0.5, 1, 0.1}}, {0.4, 0, 0.1}, 0.1},
        {{ColliderShape::bucket, {0.5, 1, 0.1}}, {0.55, 0, 0.5}, -0.05},
    };
    for (const Case& test : cases) {
        const SurfacePoint found = distance_to_collider(test.geometry, motion, test.point);
        CHECK(found.distance == Approx(test.distance).epsilon(1e-12));
        CHECK(found.normal.norm() == Approx(1).epsilon(1e-12));
        CHECK((found.point + found.distance * found.normal - test.point).norm() <= 1e-12);
        CHECK(distance_to_collider(test.geometry, motion, test.point).normal == found.normal);
    }
}

TEST_CASE("outside a bucket the nearer of its parts is the distance to it; in its corner there are two", "[unit]") {
    const ColliderGeometry bucket{ColliderShape::bucket, {0.5, 0.6, 0.1}};
    test::Random random(13);
    const RigidMotion motion = test::CollisionWorld::at(random.vector(), random.rotation());
    REQUIRE(collider_part_count(bucket.shape) == 2);
    for (int trial = 0; trial < draws(300); ++trial) {
        const Vec3 p = motion.position + motion.rotation * Vec3(random.vector());
        const Real whole = distance_to_collider(bucket, motion, p).distance;
        const Real least = std::min(distance_to_collider_part(bucket, motion, 0, p).distance,
                                    distance_to_collider_part(bucket, motion, 1, p).distance);
        if (whole > 0)
            CHECK(whole == Approx(least).epsilon(1e-12));
        else
            CHECK(least <= 0);
    }
    const Vec3 corner = motion.position + motion.rotation * Vec3(0.49, 0, 0.02);
    const SurfacePoint floor = distance_to_collider_part(bucket, motion, 0, corner),
                       wall = distance_to_collider_part(bucket, motion, 1, corner);
    CHECK(floor.distance == Approx(0.02));
    CHECK(wall.distance == Approx(0.01));
    CHECK((motion.rotation.transpose() * floor.normal - Vec3(0, 0, 1)).norm() < 1e-12);
    CHECK((motion.rotation.transpose() * wall.normal - Vec3(-1, 0, 0)).norm() < 1e-12);
}

TEST_CASE("box and radius hold the whole shape, and not much more", "[unit]") {
    test::Random random(14);
    for (const Named& shape : shapes) {
        if (shape.geometry.shape == ColliderShape::plane) continue;
        INFO(shape.name);
        const RigidMotion motion = test::CollisionWorld::at(random.vector(), random.rotation());
        const Aabb box = collider_box(shape.geometry, motion);
        Aabb tight{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
        Real radius = 0;
        for (const Vec3& local : sample_surface(shape.geometry, 0.01)) {
            const Vec3 p = motion.position + motion.rotation * local;
            tight.lower = tight.lower.cwiseMin(p);
            tight.upper = tight.upper.cwiseMax(p);
            radius = std::max(radius, local.norm());
        }
        CHECK((box.lower.array() <= tight.lower.array() + 1e-12).all());
        CHECK((box.upper.array() >= tight.upper.array() - 1e-12).all());
        CHECK((tight.lower - box.lower).maxCoeff() < 0.01);
        CHECK((box.upper - tight.upper).maxCoeff() < 0.01);
        CHECK(collider_radius(shape.geometry) >= radius - 1e-12);
        CHECK(collider_radius(shape.geometry) <= radius + 0.01);
    }
}

TEST_CASE("a point that is not a number has no distance and does no harm", "[unit]") {
    const Vec3 bad(std::numeric_limits<Real>::quiet_NaN(), 0, 0);
    for (const Named& shape : shapes)
        CHECK_FALSE(distance_to_collider(shape.geometry, test::CollisionWorld::at({1, 2, 3}), bad).distance <= 1e300);
}

}  // namespace skerry::test::collider_distance_test
