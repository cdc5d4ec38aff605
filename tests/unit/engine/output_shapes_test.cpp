#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "engine/output/shape_picture.h"

namespace skerry::test::output_shapes_test {

namespace {

struct Sum {
    Real volume = 0;     // positive if triangles face outwards [m^3]
    bool closed = true;  // every edge has its opposite, with vertices at one place counted as one
    bool flat_triangle = false;
};

Sum sum_of(const SurfaceMesh& mesh) {
    Sum sum;
    const auto key = [](const Vec3& p) {
        return std::tuple(std::lround(p.x() * 1e9), std::lround(p.y() * 1e9), std::lround(p.z() * 1e9));
    };
    std::map<std::pair<std::tuple<long, long, long>, std::tuple<long, long, long>>, int> edges;
    for (const auto& triangle : mesh.triangles) {
        const auto node = [&](int k) {
            return mesh.nodes[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k % 3)])];
        };
        sum.volume += node(0).dot(node(1).cross(node(2))) / 6;
        sum.flat_triangle |= (node(1) - node(0)).cross(node(2) - node(0)).norm() < 1e-12;
        for (int k = 0; k < 3; ++k) ++edges[{key(node(k)), key(node(k + 1))}];
    }
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        sum.closed &= opposite != edges.end() && opposite->second == count;
    }
    return sum;
}

constexpr Real pi = std::numbers::pi;

}  // namespace

TEST_CASE("pictures of solid colliders are closed, face outwards and have the volume of their shape",
          "[unit][output]") {
    const auto [shape, volume, tolerance] = GENERATE(table<Shape, Real, Real>({
        {Sphere{.radius = 0.7}, 4.0 / 3 * pi * 0.343, 0.01},
        {Box{.size = {0.5, 2, 3}}, 3.0, 1e-12},
        {Capsule{.radius = 0.2, .length = 0.9}, pi * 0.04 * 0.9 + 4.0 / 3 * pi * 0.008, 0.01},
        {Cylinder{.radius = 0.3, .height = 2}, pi * 0.09 * 2, 0.01},
        {Bucket{.radius = 0.4, .height = 1, .thickness = 0.1}, pi * (0.25 * 1.1 - 0.16 * 1), 0.01},
    }));
    const Sum sum = sum_of(shape_picture(shape, {}));
    CHECK(sum.closed);
    CHECK_FALSE(sum.flat_triangle);
    // 48 facets around the axis lose 0.3 % of a circle and up to 0.6 % of a ball.
    CHECK(sum.volume == Approx(volume).epsilon(tolerance));
}

TEST_CASE("a bucket is drawn with its floor at zero and its wall outside of the inner radius", "[unit][output]") {
    const SurfaceMesh mesh = shape_picture(Bucket{.radius = 0.4, .height = 1, .thickness = 0.1}, {});
    Real lowest = 1, highest = -1, widest = 0;
    bool has_floor = false;
    for (const Vec3& node : mesh.nodes) {
        lowest = std::min(lowest, node.z());
        highest = std::max(highest, node.z());
        widest = std::max(widest, node.head<2>().norm());
        has_floor |= node.z() == 0 && std::abs(node.head<2>().norm() - 0.4) < 1e-12;
    }
    CHECK(lowest == -0.1);
    CHECK(highest == 1);
    CHECK(widest == Approx(0.5));
    CHECK(has_floor);
}

TEST_CASE("the picture of a plane is the square of z = 0 below the middle of the scene, facing up", "[unit][output]") {
    const SurfaceMesh mesh =
        shape_picture(Plane{.normal = {1, 1, 1}, .point = {5, 5, 5}}, {.center = {2, 3, 7}, .half_size = 4});
    Vec3 lower = mesh.nodes[0], upper = lower;
    for (const Vec3& node : mesh.nodes) {
        lower = lower.cwiseMin(node);
        upper = upper.cwiseMax(node);
    }
    CHECK((lower - Vec3(-2, -1, 0)).norm() < 1e-12);
    CHECK((upper - Vec3(6, 7, 0)).norm() < 1e-12);
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto node = [&](Index n) { return mesh.nodes[static_cast<std::size_t>(n)]; };
        REQUIRE((node(b) - node(a)).cross(node(c) - node(a)).z() > 0);
    }
}

TEST_CASE("a mesh collider is its own picture", "[unit][output]") {
    const SurfaceMesh mesh{.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
    CHECK(shape_picture(mesh, {}).triangles == mesh.triangles);
    CHECK(shape_picture(SurfaceMesh{}, {}).triangles.empty());
}

TEST_CASE("a pose turns about its axis, then moves, and to_shape undoes it", "[unit][output]") {
    const MotionKey quarter{.time = 0, .position = {1, 2, 3}, .rotation = {0, 0, pi / 2}};
    CHECK((to_world(quarter, {1, 0, 0}) - Vec3(1, 3, 3)).norm() < 1e-12);
    const MotionKey pose{.time = 0, .position = {1, -2, 3}, .rotation = {0.3, -0.2, 2.9}};
    CHECK((to_shape(pose, to_world(pose, {4, 5, 6})) - Vec3(4, 5, 6)).norm() < 1e-12);
    CHECK(to_world({}, {4, 5, 6}) == Vec3(4, 5, 6));
}

}  // namespace skerry::test::output_shapes_test
