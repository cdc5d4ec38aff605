// Collision groups, masks, and pairs that are switched off.
#include <catch2/catch.hpp>

#include <fstream>

#include "skerry/joint.h"
#include "skerry/scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::collisions_test {

namespace {

/// A ball that falls onto a floor, and another that falls onto the first.
struct Stack {
    World world;
    BodyHandle lower, upper;
    ColliderHandle floor;

    explicit Stack(bool mesh = false) {
        const auto rubber = world.add_material({.young_modulus = 5e4, .damping = 20});
        floor = mesh
                    ? world.add_collider(mesh::boundary(mesh::box({1, 1, 0.1}, {1, 1, 1})), {.position = {0, 0, -0.05}})
                    : world.add_collider(Plane{});
        lower = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.055}, .name = "lower"});
        upper = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.16}, .name = "upper"});
    }
    Real height(BodyHandle body) const { return world.center_of_mass(body).z(); }
};

}  // namespace

TEST_CASE("a body in no group of the other's mask falls through", "[scene]") {
    for (const bool mesh : {false, true}) {
        Stack stack(mesh);
        stack.world.set_collision_groups(stack.lower, 2, 1);
        CHECK(stack.world.may_collide(stack.lower, stack.floor));
        stack.world.set_collision_groups(stack.upper, 4, 1);
        CHECK_FALSE(stack.world.may_collide(stack.lower, stack.upper));
        REQUIRE(stack.world.advance(1).ok());
        CHECK(stack.height(stack.lower) > 0.03);
        CHECK(stack.height(stack.upper) < 0.06);  // it has fallen through the lower ball onto the floor
        stack.world.set_collision_groups(stack.floor, 1, 2);
        CHECK_FALSE(stack.world.may_collide(stack.upper, stack.floor));
        REQUIRE(stack.world.advance(0.3).ok());
        CHECK(stack.height(stack.lower) > 0.03);
        CHECK(stack.height(stack.upper) < -0.1);
    }
}

TEST_CASE("groups that bodies and colliders are added with count", "[scene]") {
    World world;
    const auto rubber = world.add_material({});
    const auto ball =
        world.add_body(mesh::ball(0.05, 3), {.material = rubber, .position = {0, 0, 0.1}, .collision_group = 6});
    const auto one = world.add_collider(Plane{}, {.collision_mask = 1});
    const auto other = world.add_collider(Plane{}, {.collision_mask = 2});
    CHECK_FALSE(world.may_collide(ball, one));
    CHECK(world.may_collide(ball, other));
}

TEST_CASE("a pair that is switched off goes through each other, and one that is switched on is looked at as at a start",
          "[scene]") {
    for (const bool mesh : {false, true}) {
        Stack stack(mesh);
        World& world = stack.world;
        world.set_collision(stack.upper, stack.lower, false);
        CHECK_FALSE(world.may_collide(stack.lower, stack.upper));
        REQUIRE(world.advance(1).ok());
        CHECK(stack.height(stack.upper) < 0.06);
        world.set_collision(stack.lower, stack.upper, true);
        CHECK_THROWS_WITH(world.advance(0.01), Catch::Contains("upper") && Catch::Contains("lower"));
        world.set_collision(stack.lower, stack.upper, false);
        world.set_collision(stack.lower, stack.floor, false);
        REQUIRE(world.advance(0.3).ok());
        CHECK(stack.height(stack.lower) < -0.1);
        CHECK(stack.height(stack.upper) > 0.03);
    }
}

TEST_CASE("a body with itself is switched by its self-contact", "[scene]") {
    Stack stack;
    CHECK_FALSE(stack.world.may_collide(stack.lower, stack.lower));
    stack.world.set_collision(stack.lower, stack.lower, true);
    CHECK(stack.world.may_collide(stack.lower, stack.lower));
    REQUIRE(stack.world.advance(0.05).ok());
    stack.world.set_collision(stack.lower, stack.lower, false);
    REQUIRE(stack.world.advance(0.05).ok());
    CHECK_FALSE(stack.world.may_collide(stack.lower, stack.lower));
}

TEST_CASE("what a slot was switched off from is forgotten when what had it is removed", "[scene]") {
    Stack stack;
    World& world = stack.world;
    world.set_collision(stack.lower, stack.upper, false);
    world.set_collision(stack.upper, stack.floor, false);
    world.remove(stack.upper);
    const auto rubber = world.add_material({});
    const auto next = world.add_body(mesh::ball(0.05, 3), {.material = rubber, .position = {0, 0, 0.3}});
    REQUIRE(next.slot == stack.upper.slot);
    CHECK(world.may_collide(stack.lower, next));
    CHECK(world.may_collide(next, stack.floor));
    world.set_collision(next, stack.floor, false);
    world.remove(stack.floor);
    const auto floor = world.add_collider(Plane{});
    CHECK(world.may_collide(next, floor));
}

TEST_CASE("groups and switches are part of the state, and are kept by copies and files", "[scene][determinism]") {
    Stack stack;
    World& world = stack.world;
    REQUIRE(world.advance(0.01).ok());
    const std::uint64_t before = world.state_hash();
    world.set_collision(stack.lower, stack.upper, false);
    CHECK(world.state_hash() != before);
    world.set_collision(stack.lower, stack.upper, true);
    world.set_collision_groups(stack.upper, 8, 3);
    CHECK(world.state_hash() != before);
    world.set_collision(stack.lower, stack.upper, false);
    world.set_surface_properties(stack.lower, {.friction = 0.1});
    const TemporaryFolder folder;
    world.save(folder.path() / "world.skerry");
    World loaded = World::load(folder.path() / "world.skerry"), copy = world.clone();
    REQUIRE(world.advance(0.3).ok());
    REQUIRE(loaded.advance(0.3).ok());
    REQUIRE(copy.advance(0.3).ok());
    CHECK(loaded.state_hash() == world.state_hash());
    CHECK(copy.state_hash() == world.state_hash());
    CHECK_FALSE(loaded.may_collide(stack.lower, stack.upper));
}

TEST_CASE("bodies that do not collide may overlap at the start", "[scene]") {
    World world;
    const auto rubber = world.add_material({});
    const auto a = world.add_body(mesh::ball(0.05, 3), {.material = rubber});
    const auto b = world.add_body(mesh::ball(0.05, 3), {.material = rubber});
    world.set_collision(a, b, false);
    const auto box = world.add_collider(Box{{0.2, 0.2, 0.2}}, {.collision_group = 2, .collision_mask = 2});
    CHECK_FALSE(world.may_collide(a, box));
    REQUIRE(world.advance(0.01).ok());
    CHECK(world.report().start_overlaps.empty());
}

TEST_CASE("a scene has groups and masks, and refuses values without 32 bits", "[scene]") {
    const TemporaryFolder folder;
    const auto scene = [&](const std::string& group) {
        return folder.write("scene.json", R"({"materials": {"rubber": {}},
            "bodies": [{"mesh": {"ball": {"radius": 0.05, "resolution": 3}}, "material": "rubber",
                        "position": [0, 0, 1],
                        "collision_group": )" +
                                              group + R"(, "collision_mask": 4294967295}],
            "colliders": [{"shape": {"plane": {}}, "collision_mask": 4}]})");
    };
    const auto collides = [&](const std::string& group) {
        const Scene loaded = load_scene(scene(group));
        return loaded.world.may_collide(loaded.world.bodies()[0], loaded.world.colliders()[0]);
    };
    CHECK(collides("4"));
    CHECK_FALSE(collides("3"));
    CHECK_THROWS_WITH(collides("-1"), Catch::Contains("collision_group"));
    CHECK_THROWS_WITH(collides("4294967296"), Catch::Contains("collision_group"));
    CHECK_THROWS_WITH(collides("1.5"), Catch::Contains("collision_group"));
}

TEST_CASE("a scene lists pairs that do not collide, also without their joint, and names mistakes", "[scene]") {
    const TemporaryFolder folder;
    const auto scene = [&](const std::string& pair) {
        const std::string block = R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber",
            "dynamics": "rigid")";
        return load_scene(folder.write("pairs.json", R"({"materials": {"rubber": {}},
            "bodies": [{"name": "a", "position": [0, 0, 1], )" +
                                                         block + R"(},
                       {"name": "b", "position": [0, 0, 1.5], )" +
                                                         block + R"(}],
            "colliders": [{"name": "floor", "shape": {"plane": {}}}], "joints": [{"kind": "ball", "first": "a",
            "second": "b"}], "no_collision": [{"body": "a", "to_body": "b"}, )" +
                                                         pair + "]}"));
    };
    Scene loaded = scene(R"({"body": "b", "to_collider": "floor"})");
    World& world = loaded.world;
    const BodyHandle a = world.bodies()[0], b = world.bodies()[1];
    CHECK(world.may_collide(a, world.colliders()[0]));
    CHECK_FALSE(world.may_collide(b, world.colliders()[0]));
    Joints(world).remove(Joints(world).all()[0]);
    CHECK_FALSE(world.may_collide(a, b));
    CHECK(world.report().start_overlaps.empty());
    CHECK_THROWS_WITH(scene(R"({"body": "a"})"), Catch::Contains("no_collision[1]"));
    CHECK_THROWS_WITH(scene(R"({"body": "a", "to_body": "c"})"),
                      Catch::Contains("no_collision[1].to_body: found \"c\", expected the name of a body"));
    CHECK_THROWS_WITH(scene(R"({"body": "a", "to_body": "a"})"),
                      Catch::Contains("no_collision[1].to_body: found \"a\", the name under \"body\""));
}

}  // namespace skerry::test::collisions_test
