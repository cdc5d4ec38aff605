// Setting positions of bodies, and the cost of many set_loads.
#include <catch2/catch.hpp>

#include "engine/world/world_state.h"
#include "systems/geometry/rotation.h"
#include "tests/support/worlds.h"

namespace skerry::test::bodies_test {

namespace {

std::vector<Vec3> moved(std::span<const Vec3> position, const Mat3& turn, const Vec3& by) {
    std::vector<Vec3> there;
    for (const Vec3& x : position) there.push_back(turn * x + by);
    return there;
}

struct TwoBalls {
    World world;
    Mesh mesh = mesh::ball(0.05, 4);
    BodyHandle first, second;

    explicit TwoBalls(MaterialModel model = MaterialModel::stable_neo_hookean) : world({.gravity = {0, 0, 0}}) {
        const auto rubber = world.add_material({.young_modulus = 5e4, .model = model});
        first = world.add_body(mesh, {.material = rubber, .name = "first"});
        second = world.add_body(mesh, {.material = rubber, .position = {0.2, 0, 0}, .name = "second"});
    }
};

}  // namespace

TEST_CASE("a body that is put elsewhere, turned, goes on without strain and with its velocities", "[scene]") {
    for (const MaterialModel model : {MaterialModel::stable_neo_hookean, MaterialModel::corotational}) {
        TwoBalls scene(model);
        World& world = scene.world;
        world.set_velocities(scene.first, std::vector<Vec3>(scene.mesh.nodes.size(), Vec3(0.1, 0, 0)));
        REQUIRE(world.advance(0.05).ok());
        const Mat3 turn = rotation_matrix({1, 2, 0.5});
        world.set_positions(scene.first, moved(scene.mesh.nodes, turn, {0, 3, 0}));
        const Vec3 start = world.center_of_mass(scene.first);
        REQUIRE(world.advance(0.1).ok());
        CHECK((world.center_of_mass(scene.first) - start - Vec3(0.01, 0, 0)).norm() < 1e-12);
        CHECK(world.energy().elastic < 1e-12);
    }
}

TEST_CASE("a body that is stretched by hand swings back", "[scene]") {
    TwoBalls scene;
    World& world = scene.world;
    const Real stable = world.stable_step();
    Mat3 stretch = Mat3::Identity();
    stretch(2, 2) = 0.4;
    world.set_positions(scene.first, moved(scene.mesh.nodes, stretch, Vec3::Zero()));
    CHECK(world.energy().elastic > 0);
    CHECK(world.stable_step() < stable);
    REQUIRE(world.advance(2).ok());
    Real height = 0;
    for (const Vec3& x : world.positions(scene.first)) height = std::max(height, x.z());
    CHECK(height == Approx(0.05).epsilon(0.05));
}

TEST_CASE("positions that turn an element inside out are refused by its number, and change nothing", "[scene]") {
    TwoBalls scene;
    World& world = scene.world;
    REQUIRE(world.advance(0.01).ok());
    const std::uint64_t before = world.state_hash();
    Mat3 mirror = Mat3::Identity();
    mirror(0, 0) = -1;
    using Catch::Contains;
    CHECK_THROWS_WITH(world.set_positions(scene.first, moved(scene.mesh.nodes, mirror, Vec3::Zero())),
                      Contains("body 'first'") && Contains("position") && Contains("tetrahedron 0"));
    CHECK_THROWS_WITH(world.set_positions(scene.first, std::vector<Vec3>(3)), Contains("3 values"));
    std::vector<Vec3> broken(scene.mesh.nodes);
    broken[7].y() = std::nan("");
    CHECK_THROWS_WITH(world.set_positions(scene.first, broken), Contains("node 7"));
    CHECK(world.state_hash() == before);
}

TEST_CASE("a body that is put into another is moved apart or refused as at a start", "[scene]") {
    TwoBalls scene;
    World& world = scene.world;
    REQUIRE(world.advance(0.01).ok());
    world.set_positions(scene.first, moved(scene.mesh.nodes, Mat3::Identity(), {0.12, 0, 0}));
    world.settle_start();
    REQUIRE(world.report().start_overlaps.size() == 1);
    CHECK(world.center_of_mass(scene.first).x() < 0.11);                        // the first ball is moved away
    CHECK(world.center_of_mass(scene.second).x() == Approx(0.2).margin(1e-9));  // the second has made steps and stays
    REQUIRE(world.advance(0.01).ok());
    world.set_positions(scene.first, moved(scene.mesh.nodes, Mat3::Identity(), {0.2, 0, 0}));
    CHECK_THROWS_WITH(world.advance(0.01), Catch::Contains("coincide"));
}

TEST_CASE("nodes that are held are held where they are put", "[scene]") {
    TwoBalls scene;
    World& world = scene.world;
    world.attach(scene.first, std::vector<Index>{0, 1, 2}, {.velocity = {0, 0, 0.1}});
    REQUIRE(world.advance(0.1).ok());
    world.set_positions(scene.first, moved(scene.mesh.nodes, Mat3::Identity(), {0, 0, 1}));
    const Vec3 held = world.positions(scene.first)[1];
    REQUIRE(world.advance(0.1).ok());
    CHECK((world.positions(scene.first)[1] - held - Vec3(0, 0, 0.01)).norm() < 1e-12);
}

TEST_CASE("whether any body has loads is known after each is set, added and removed", "[scene]") {
    TwoBalls scene;
    World& world = scene.world;
    const std::vector<Vec3> some(scene.mesh.nodes.size(), Vec3(0, 0, 1e-3)), none(some.size(), Vec3::Zero());
    const auto loaded = [&] { return WorldAccess::state_of(world).model.forced; };
    CHECK_FALSE(loaded());
    world.set_loads(scene.first, some);
    world.set_loads(scene.first, some);
    world.set_loads(scene.second, some);
    CHECK(loaded());
    world.set_loads(scene.first, none);
    CHECK(loaded());
    world.remove(scene.second);
    CHECK_FALSE(loaded());
    world.set_loads(scene.first, some);
    CHECK(loaded());
    world.set_loads(scene.first, none);
    CHECK_FALSE(loaded());
    REQUIRE(world.advance(0.01).ok());
    CHECK(world.center_of_mass(scene.first).norm() < 1e-12);
}

}  // namespace skerry::test::bodies_test
