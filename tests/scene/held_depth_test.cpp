// Overlaps of surfaces that no contact can move: nodes that attachments hold, inside colliders and other held bodies.
#include <catch2/catch.hpp>

#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::held_depth_test {

namespace {

constexpr Real edge = 0.1, depth = 0.02;

std::vector<Index> all_nodes(const World& world, BodyHandle body) {
    std::vector<Index> nodes(world.positions(body).size());
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<Index>(n);
    return nodes;
}

/// A world with a cube whose lower face is 1 cm above z = 0. All of its nodes are held, and move down by 3 cm in 0.1 s.
struct Led {
    World world{Settings{.gravity = Vec3::Zero()}};
    MaterialHandle material = world.add_material({});
    BodyHandle cube;

    explicit Led(BodyDynamics dynamics = BodyDynamics::explicit_elastic) {
        cube = world.add_body(
            mesh::box({edge, edge, edge}, {2, 2, 2}),
            {.material = material, .position = {0, 0, edge / 2 + 0.01}, .dynamics = dynamics, .name = "cube"});
    }
    void lead() {
        world.attach(cube, all_nodes(world, cube), {.keys = {{0, {0, 0, 0}}, {0.1, {0, 0, -0.01 - depth}}}});
    }
};

}  // namespace

TEST_CASE("held nodes inside a collider of any shape are reported with their depth and names", "[scene]") {
    struct Case {
        const char* name;
        Shape shape;
        ColliderSettings collider;
    };
    // The upper side of each collider is at z = 0.
    const Case cases[] = {
        {"plane", Plane{}, {.name = "floor"}},
        {"box", Box{{1, 1, 1}}, {.position = {0, 0, -0.5}, .name = "floor"}},
        {"cylinder", Cylinder{1, 1}, {.position = {0, 0, -0.5}, .name = "floor"}},
        {"bucket", Bucket{}, {.name = "floor"}},
        {"mesh", mesh::boundary(mesh::box({1, 1, 1}, {4, 4, 4})), {.position = {0, 0, -0.5}, .name = "floor"}}};
    for (const Case& test_case : cases) {
        INFO(test_case.name);
        Led led;
        led.world.add_collider(test_case.shape, test_case.collider);
        led.lead();
        const StepReport report = led.world.advance(0.1);
        REQUIRE(report.ok());
        CHECK(report.held_penetration == Approx(depth).epsilon(0.05));  // the last step begins before the end
        const WorldReport of_run = led.world.report();
        CHECK(of_run.held_penetration == report.held_penetration);
        CHECK(of_run.held_body == "cube");
        CHECK(of_run.held_in == "floor");
        CHECK(of_run.max_penetration == 0);
    }
}

TEST_CASE("held bodies of every kind that are led into each other are reported", "[scene]") {
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        INFO(name_of(dynamics));
        Led led(dynamics);
        const auto base = led.world.add_body(
            mesh::box({0.3, 0.3, edge}, {3, 3, 1}),
            {.material = led.material, .position = {0.01, 0.02, -edge / 2}, .dynamics = dynamics, .name = "base"});
        led.world.attach(base, all_nodes(led.world, base));
        led.lead();
        REQUIRE(led.world.advance(0.1).ok());
        const WorldReport report = led.world.report();
        CHECK(std::max(report.held_penetration, report.max_penetration) == Approx(depth).epsilon(0.05));
    }
}

TEST_CASE("nodes that contacts can move do not count as held, and a touch is no overlap", "[scene]") {
    Led led;
    led.world.add_collider(Plane{}, {.position = {0, 0, 0.005}});
    std::vector<Index> upper;
    for (const Index n : all_nodes(led.world, led.cube))
        if (led.world.positions(led.cube)[static_cast<std::size_t>(n)].z() > 0.1) upper.push_back(n);
    led.world.attach(led.cube, upper, {.keys = {{0, {0, 0, 0}}, {0.1, {0, 0, -0.02}}}});
    REQUIRE(led.world.advance(0.1).ok());
    CHECK(led.world.report().max_contacts > 0);
    CHECK(led.world.report().held_penetration == 0);
}

TEST_CASE("the overlap of held surfaces is kept by copies and files, and forgets removed objects", "[scene]") {
    Led led;
    const auto floor = led.world.add_collider(Plane{}, {.name = "floor"});
    led.lead();
    REQUIRE(led.world.advance(0.1).ok());
    const Real deepest = led.world.report().held_penetration;
    CHECK(led.world.clone().report().held_in == "floor");
    const TemporaryFolder folder;
    led.world.save(folder.path() / "w.skerry");
    const WorldReport loaded = World::load(folder.path() / "w.skerry").report();
    CHECK(loaded.held_penetration == deepest);
    CHECK(loaded.held_body == "cube");
    CHECK(loaded.held_in == "floor");
    led.world.remove(floor);
    led.world.add_collider(Plane{}, {.position = {0, 0, -9}, .name = "other"});  // takes the slot of the removed one
    CHECK(led.world.report().held_penetration == deepest);
    CHECK(led.world.report().held_in.empty());
}

}  // namespace skerry::test::held_depth_test
