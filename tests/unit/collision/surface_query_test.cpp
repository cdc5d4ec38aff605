// Rays and nearest points: the tree against a tree with endless boxes, which tests all triangles, closed forms against
// distances.
#include <catch2/catch.hpp>

#include <limits>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/query/collider_ray.h"
#include "systems/collision/query/surface_query.h"
#include "systems/geometry/rotation.h"
#include "tests/support/collision_world.h"
#include "tests/support/random.h"

namespace skerry::test::surface_query_test {

namespace {

constexpr Real far = std::numeric_limits<Real>::infinity();

/// A closed surface from the grid of a deformed ball, with its tree.
struct Surface {
    Column<Vec3> position;
    Column<std::array<Index, 3>> triangle;
    BvhTable bvh;
    BvhLeafTable leaves;
    Column<Aabb> endless;   // boxes that every ray meets
    SurfaceTree tree, all;  // `all` has endless boxes, so that a query tests all triangles

    Surface(Random& random, int rings) {
        const int around = 2 * rings;
        const auto add = [&](Real up, Real turn) {
            const Vec3 on_ball(std::sin(up) * std::cos(turn), std::sin(up) * std::sin(turn), std::cos(up));
            position.push_back(on_ball + 0.1 * random.vector());
        };
        const Real pi = std::acos(-1.0);
        add(0, 0);
        for (int i = 1; i < rings; ++i)
            for (int j = 0; j < around; ++j) add(pi * i / rings, 2 * pi * j / around);
        add(pi, 0);
        const auto at = [&](int i, int j) { return static_cast<Index>(1 + (i - 1) * around + j % around); };
        const Index last = static_cast<Index>(position.size()) - 1;
        for (int j = 0; j < around; ++j) {
            triangle.push_back({0, at(1, j), at(1, j + 1)});
            for (int i = 1; i + 1 < rings; ++i) {
                triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
            triangle.push_back({at(rings - 1, j), last, at(rings - 1, j + 1)});
        }
        const Range rows{0, static_cast<Index>(triangle.size())};
        const BvhRanges ranges = append_bvh(rows, triangle, position, bvh, leaves);
        for (Vec3& x : position) x += 0.05 * random.vector();  // the surface deforms, the structure of the tree stays
        refit_bvh(ranges.nodes, bvh.node, leaves.nodes, position, bvh.box.span());
        endless.resize(bvh.box.size(), {Vec3::Constant(-far), Vec3::Constant(far)});
        tree = {ranges.nodes, bvh.node, leaves.triangle, bvh.box, triangle, position};
        all = tree;
        all.box = endless;
    }
};

void check_same(const std::optional<TrianglePoint>& found, const std::optional<TrianglePoint>& expected) {
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) return;
    CHECK(found->triangle == expected->triangle);
    CHECK(found->weight == expected->weight);
    CHECK(found->distance == expected->distance);
}

Vec3 point_of(const Surface& surface, const TrianglePoint& at) {
    const auto& node = surface.triangle[static_cast<std::size_t>(at.triangle)];
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) point += at.weight[k] * surface.position[static_cast<std::size_t>(node[k])];
    return point;
}

RigidMotion random_pose(Random& random) {
    return {random.vector(), rotation_matrix(3 * random.vector()), Vec3::Zero(), Vec3::Zero()};
}

}  // namespace

TEST_CASE("the tree gives the triangle, weights and distance that all triangles one by one give", "[unit]") {
    Random random(20261123);
    int hits = 0;
    for (int shape = 0; shape < 20; ++shape) {
        const Surface surface(random, 3 + shape / 2);
        for (int i = 0; i < 300; ++i) {
            const Vec3 from = 2 * random.vector();
            const Ray ray{from, (0.8 * random.vector() - from).normalized()};
            const Real limit = i % 3 == 0 ? 1.0 : far;
            const auto found = cast_ray(surface.tree, ray, limit);
            check_same(found, cast_ray(surface.all, ray, limit));
            if (found) {
                ++hits;
                CHECK((point_of(surface, *found) - ray.origin - found->distance * ray.direction).norm() < 1e-12);
            }
            const Real within = i % 3 == 0 ? 0.3 : far;
            check_same(nearest_point(surface.tree, ray.origin, within), nearest_point(surface.all, ray.origin, within));
        }
    }
    CHECK(hits > 1000);
}

TEST_CASE("rays through corners, edges and along the axes leave no closed surface unseen", "[unit]") {
    Random random(7);
    const Surface surface(random, 8);
    const auto seen = [&](const Vec3& from, const Vec3& target) {
        const auto found = cast_ray(surface.tree, {from, (target - from).normalized()}, far);
        REQUIRE(found);
        check_same(found, cast_ray(surface.all, {from, (target - from).normalized()}, far));
    };
    for (const Vec3& corner : surface.position) seen({0, 0, 0}, corner);
    for (const auto& node : surface.triangle)
        for (std::size_t k = 0; k < 3; ++k)
            seen({0.01, 0.02, 0}, (surface.position[static_cast<std::size_t>(node[k])] +
                                   surface.position[static_cast<std::size_t>(node[(k + 1) % 3])]) /
                                      2);
    for (int axis = 0; axis < 3; ++axis)
        for (const Real side : {-1.0, 1.0}) CHECK(cast_ray(surface.tree, {Vec3::Zero(), side * Vec3::Unit(axis)}, far));
}

TEST_CASE("a ray meets an analytic shape where its distance is first zero, with the normal of the distance", "[unit]") {
    Random random(11);
    const ColliderGeometry shapes[] = {
        {ColliderShape::plane, Vec3::Zero()},     {ColliderShape::sphere, {0.6, 0, 0}},
        {ColliderShape::box, {0.3, 0.5, 0.7}},    {ColliderShape::capsule, {0.3, 0.5, 0}},
        {ColliderShape::cylinder, {0.4, 0.6, 0}}, {ColliderShape::bucket, {0.5, 0.8, 0.1}}};
    for (const ColliderGeometry& geometry : shapes) {
        CAPTURE(static_cast<int>(geometry.shape));
        int hits = 0, inside = 0;
        for (int i = 0; i < 2000; ++i) {
            const RigidMotion pose = random_pose(random);
            const Vec3 from = 2 * random.vector();
            const Ray ray{pose.position + from, (0.5 * random.vector() - from).normalized()};
            const auto distance = [&](Real t) {
                return distance_to_collider(geometry, pose, ray.origin + t * ray.direction);
            };
            const auto found = cast_ray(geometry, pose, ray, 8);
            const Real side = distance(0).distance > 0 ? 1 : -1;
            const Real end = found ? found->distance : 8;
            for (int k = 0; k < 200; ++k)  // up to the hit the ray is on one side
                REQUIRE(side * distance(k / 200.0 * end).distance > -1e-12);
            if (!found) continue;
            ++hits;
            inside += side < 0;
            CHECK(std::abs(distance(found->distance).distance) < 1e-12);
            constexpr Real step = 1e-6;  // near an edge the normal is that of the side that was hit
            const Vec3 out = ray.origin + found->distance * ray.direction + step * found->normal;
            CHECK(distance_to_collider(geometry, pose, out).distance == Approx(step).epsilon(1e-3));
            CHECK_FALSE(cast_ray(geometry, pose, ray, found->distance * 0.999));
        }
        CHECK(hits > 200);
        CHECK(inside > 5);
    }
}

}  // namespace skerry::test::surface_query_test
