// Ray casts and nearest points in worlds with deforming bodies.
#include <catch2/catch.hpp>

#include <limits>

#include "systems/geometry/closest_points.h"
#include "tests/support/random.h"
#include "tests/support/worlds.h"

namespace skerry::test::queries_test {

namespace {

constexpr Real far = std::numeric_limits<Real>::infinity();

struct Pressed {
    World world;
    std::vector<BodyHandle> balls;
    ColliderHandle floor, wedge, post;

    Pressed() {
        const auto rubber = world.add_material({.young_modulus = 2e4});
        floor = world.add_collider(Plane{}, {.name = "floor"});
        wedge = world.add_collider(mesh::boundary(mesh::box({0.1, 0.1, 0.02}, {2, 2, 1})),
                                   {.position = {0, 0, 0.2}, .motion = {.velocity = {0, 0, -0.3}}});
        post = world.add_collider(Capsule{0.02, 0.1}, {.position = {0.3, 0, 0.1}, .rotation = {0, 1, 0}});
        for (int i = 0; i < 2; ++i)
            balls.push_back(world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0.15 * i, 0, 0.06}}));
    }

    /// Distance from a point to the surface of a body, by testing all triangles.
    Real nearest_of_all(BodyHandle body, const Vec3& point) const {
        Real squared = far;
        const auto x = world.positions(body);
        for (const auto& [a, b, c] : world.surface(body))
            squared = std::min(squared,
                               closest_point_on_triangle(point, x[static_cast<std::size_t>(a)],
                                                         x[static_cast<std::size_t>(b)], x[static_cast<std::size_t>(c)])
                                   .distance_squared);
        return std::sqrt(squared);
    }
};

}  // namespace

TEST_CASE("queries answer by the shapes of now, step after step, and change no bit", "[scene]") {
    Pressed scene, unasked;
    Random random(3);
    int of_bodies = 0;
    for (int i = 0; i < 40; ++i) {
        REQUIRE(scene.world.advance(0.01).ok());
        REQUIRE(unasked.world.advance(0.01).ok());
        for (int k = 0; k < 20; ++k) {
            const Vec3 point = Vec3(0.1, 0, 0.1) + 0.15 * random.vector();
            const auto found = scene.world.nearest_point(point, far, {.colliders = false});
            REQUIRE(found);
            const Real least =
                std::min(scene.nearest_of_all(scene.balls[0], point), scene.nearest_of_all(scene.balls[1], point));
            CHECK(found->distance == Approx(least).epsilon(1e-12));
            const auto any = scene.world.nearest_point(point, far);
            REQUIRE(any);
            CHECK(any->distance <= found->distance);
            CHECK((any->point - point).norm() == Approx(any->distance).margin(1e-12));
            // A ray to the nearest point hits at the distance of that point, and nothing before.
            const auto met = scene.world.cast_ray(point, any->point - point, far);
            REQUIRE(met);
            CHECK(met->distance == Approx(any->distance).margin(1e-9));
            of_bodies += any->body != BodyHandle{};
        }
    }
    CHECK(of_bodies > 100);
    CHECK(scene.world.state_hash() == unasked.world.state_hash());
    CHECK(scene.world.report().pair_searches == unasked.world.report().pair_searches);
}

TEST_CASE("a hit names body or collider, triangle, weights and an outward normal", "[scene]") {
    Pressed scene;
    World& world = scene.world;
    const auto top = world.cast_ray({0.151, 0.002, 1}, {0, 0, -2}, 10);
    REQUIRE(top);
    CHECK(top->body == scene.balls[1]);
    CHECK(top->collider == ColliderHandle{});
    CHECK(top->normal.z() > 0.9);
    CHECK(top->distance == Approx(1 - top->point.z()));
    const auto x = world.positions(top->body);
    const auto& corner = world.surface(top->body)[static_cast<std::size_t>(top->triangle)];
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) point += top->barycentric[k] * x[static_cast<std::size_t>(corner[k])];
    CHECK((point - Vec3(0.151, 0.002, top->point.z())).norm() < 1e-12);

    const auto mesh = world.cast_ray({0.01, 0.02, 1}, {0, 0, -1}, 10);
    REQUIRE(mesh);
    CHECK(mesh->collider == scene.wedge);
    CHECK(mesh->triangle >= 0);
    CHECK(mesh->point.z() == Approx(0.21));
    const auto below = world.cast_ray({0.01, 0.02, 1}, {0, 0, -1}, 10, {.except_colliders = {scene.wedge}});
    REQUIRE(below);
    CHECK(below->body == scene.balls[0]);
    const auto floor =
        world.cast_ray({0.01, 0.02, 1}, {0, 0, -1}, 10, {.bodies = false, .except_colliders = {scene.wedge}});
    REQUIRE(floor);
    CHECK(floor->collider == scene.floor);
    CHECK(floor->triangle == -1);
    CHECK(floor->distance == Approx(1));
    const auto post = world.nearest_point({0.3, 0, 0.15}, 1, {.bodies = false});
    REQUIRE(post);
    CHECK(post->collider == scene.post);
    CHECK_FALSE(world.cast_ray({0.01, 0.02, 1}, {0, 0, -1}, 0.5));
    CHECK_FALSE(world.cast_ray({0, 0, 1}, {0, 0, 1}, far));
    CHECK_FALSE(world.nearest_point({0, 0, 5}, 1));
    CHECK_FALSE(world.nearest_point({0, 0, 0.1}, far, {.groups = 2}));
    world.set_collision_groups(scene.balls[1], 3, 1);
    CHECK(world.nearest_point({0, 0, 0.1}, far, {.groups = 2})->body == scene.balls[1]);
}

TEST_CASE("queries follow bodies that are put elsewhere, come or go, and colliders that are set", "[scene]") {
    Pressed scene;
    World& world = scene.world;
    const auto seen = [&](Real x) { return world.cast_ray({x, 0.001, 1}, {0, 0, -1}, far, {.colliders = false}); };
    REQUIRE(seen(0.151));
    CHECK_FALSE(seen(0.9));
    std::vector<Vec3> there(world.positions(scene.balls[1]).begin(), world.positions(scene.balls[1]).end());
    for (Vec3& x : there) x += Vec3(0.75, 0, 0);
    world.set_positions(scene.balls[1], there);
    CHECK(seen(0.9));
    CHECK_FALSE(seen(0.151));
    world.remove(scene.balls[0]);
    CHECK(seen(0.9));
    CHECK_FALSE(seen(0.001));
    world.set_pose(scene.wedge, {{2, 0, 0.5}, {0, 0, 0}});
    world.set_pose(scene.post, {{3, 0, 0.5}, {0, 0, 0}});
    CHECK(world.cast_ray({2.01, 0.02, 1}, {0, 0, -1}, far)->collider == scene.wedge);
    CHECK(world.cast_ray({3.01, 0.002, 1}, {0, 0, -1}, far)->collider == scene.post);
}

TEST_CASE("questions without a meaning are refused by name", "[scene]") {
    Pressed scene;
    using Catch::Contains;
    CHECK_THROWS_WITH(scene.world.cast_ray({0, 0, 0}, {0, 0, 0}, 1), Contains("direction"));
    CHECK_THROWS_WITH(scene.world.cast_ray({0, 0, std::nan("")}, {0, 0, 1}, 1), Contains("origin"));
    CHECK_THROWS_WITH(scene.world.cast_ray({0, 0, 0}, {0, 0, 1}, -1), Contains("max_distance"));
    CHECK_THROWS_WITH(scene.world.nearest_point({0, 0, 0}, std::nan("")), Contains("max_distance"));
}

}  // namespace skerry::test::queries_test
