// Conservation of momentum in whole steps, and bodies and nodes that are held or moved.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/world/tuning.h"
#include "systems/geometry/rotation.h"
#include "tests/support/worlds.h"

namespace skerry::test::scene_motion_test {

TEST_CASE("a time that more steps than an int counts would fill is refused before the first step", "[scene]") {
    World world(Settings{.step_size = 1e-30});
    world.add_body(mesh::box({1, 1, 1}, {1, 1, 1}), {.material = world.add_material({}), .contact_distance = {}});
    CHECK_THROWS_WITH(world.advance(1e-3), Catch::Contains("0.001 s in steps of 1e-30 s"));
    CHECK(world.time() == 0);
    CHECK(world.advance(1e-29).steps == 10);
}

TEST_CASE("two bodies that collide keep their common momentum", "[scene]") {
    const Friction friction = GENERATE(Friction::cone, Friction::pyramid);
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.friction = friction;
    World world(settings);
    const auto material = world.add_material({.young_modulus = 5e4, .friction = 0.6});
    world.add_body(mesh::ball(0.05, 5), {.material = material, .position = {-0.06, 0, 0}, .velocity = {1, 0, 0}});
    world.add_body(mesh::ball(0.05, 5),
                   {.material = material, .position = {0.06, 0.03, 0.01}, .velocity = {-1, 0.5, 0}});
    const WorldReport before = world.report();
    REQUIRE(world.advance(0.15).ok());
    const WorldReport after = world.report();
    REQUIRE(after.max_contacts > 3);
    const Real scale = world.mass(world.bodies()[0]) * 2;  // sum of m |v| at a speed of 1 m/s
    CHECK((after.momentum - before.momentum).norm() <= 1e-13 * scale * static_cast<Real>(after.steps));
    CHECK(after.energy.kinetic + after.energy.elastic < before.energy.kinetic + before.energy.elastic);
}

TEST_CASE("a report names the collider that turns fastest, and by how much in a step", "[scene]") {
    World world(Settings{.step_size = 0.01});
    world.add_collider(Plane{}, {.position = {0, 0, -1}});
    CHECK(world.report().collider_turn == 0);
    world.add_body(Sphere{0.1}, {.material = world.add_material({}), .dynamics = BodyDynamics::rigid});
    CHECK(world.report().collider_turn == 0);
    world.add_collider(Plane{}, {.position = {0, 0, -9}, .motion = {.angular_velocity = {0, 3, 4}}, .name = "mill"});
    CHECK(world.report().collider_turn == Approx(0.05).epsilon(1e-12));
    CHECK(world.report().turning_collider == "mill");
    // The plane turns by 3 rad in a tenth of a second, then the shorter way by a quarter turn about another axis.
    const Vec3 along(0, 0, 3);
    const Vec3 across = rotation_vector(rotation_matrix({0.5 * std::numbers::pi, 0, 0}) * rotation_matrix(along));
    world.add_collider(Plane{}, {.position = {0, 0, -9},
                                 .motion = {.keys = {{0, {0, 0, -9}, Vec3::Zero()},
                                                     {0.1, {0, 0, -9}, along},
                                                     {0.6, {0, 0, -9}, across},
                                                     {0.61, {0, 0, -9}, across}}},
                                 .name = "whisk"});
    CHECK(world.report().collider_turn == Approx(0.3).epsilon(1e-12));
    CHECK(world.report().turning_collider == "whisk");
    world.add_collider(Plane{}, {.position = {0, 0, -9},
                                 .motion = {.keys = {{0, {0, 0, -9}, along}, {0.01, {0, 0, -9}, across}}},
                                 .name = "turn"});
    CHECK(world.report().collider_turn == Approx(0.5 * std::numbers::pi).epsilon(1e-12));
}

TEST_CASE("colliders turn by whole turns between keys, whatever their shape", "[scene]") {
    constexpr Real pi = std::numbers::pi;
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = world.add_material({})});
    ColliderSettings collider;
    collider.collision_mask = 0;
    // Three turns, then a rotation that passes through half a turn.
    collider.motion.keys = {{0, {5, 0, 0}, {0, 0, 0}},
                            {1, {5, 0, 0}, {6 * pi, 0, 0}},
                            {2, {5, 0, 0}, {0.9 * pi, 0, 0}},
                            {3, {5, 0, 0}, {1.1 * pi, 0, 0}}};
    struct Case {
        ColliderHandle collider;
        Mat3 frame;  // own orientation without the turn
    };
    std::vector<Case> cases;
    for (const Shape& shape : {Shape(Box{}), Shape(Cylinder{}), Shape(Plane{})}) {
        ColliderSettings still;
        still.position = {5, 0, 0};
        const auto at_rest = world.add_collider(shape, still);
        const Mat3 frame = rotation_matrix(world.pose(at_rest).rotation);
        world.remove(at_rest);
        cases.push_back({world.add_collider(shape, collider), frame});
    }
    Real worst = 0;
    for (int k = 1; k <= 60; ++k) {
        REQUIRE(world.advance(0.05).ok());
        const Real t = world.time();
        const Real angle = t < 1 ? 6 * pi * t : t < 2 ? 6 * pi + (t - 1) * (0.9 - 6) * pi : (0.9 + 0.2 * (t - 2)) * pi;
        for (const Case& test_case : cases) {
            const Mat3 expected = rotation_matrix({angle, 0, 0}) * test_case.frame;
            worst = std::max(worst, (rotation_matrix(world.pose(test_case.collider).rotation) - expected).norm());
        }
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("pinned nodes stay where they are", "[scene]") {
    World world;
    const auto material = world.add_material({.young_modulus = 1e5, .damping = 40});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.4}, {2, 2, 8});
    const auto bar = world.add_body(mesh, {.material = material});
    std::vector<Index> top;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z() > 0.2 - 1e-9) top.push_back(static_cast<Index>(n));
    REQUIRE(top.size() == 9);
    world.attach(bar, top);
    REQUIRE(world.advance(0.5).ok());
    for (Index n : top)
        CHECK(world.positions(bar)[static_cast<std::size_t>(n)] == mesh.nodes[static_cast<std::size_t>(n)]);
    CHECK(world.center_of_mass(bar).z() < -1e-3);  // the free part hangs down
}

TEST_CASE("an attachment follows its keys, and a released body is free again", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto material = world.add_material({.young_modulus = 1e5, .damping = 20});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto body = world.add_body(mesh, {.material = material});
    std::vector<Index> all(mesh.nodes.size());
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Index>(n);
    Motion motion;
    motion.keys = {{0, Vec3::Zero(), Vec3::Zero()}, {0.5, {1, 0, 0}, {0, 0, std::numbers::pi / 2}}};
    const auto held = world.attach(body, all, motion);
    REQUIRE(world.advance(0.5).ok());
    const Mat3 quarter = Eigen::AngleAxis<Real>(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        CHECK((world.positions(body)[n] - (Vec3(1, 0, 0) + quarter * mesh.nodes[n])).norm() < 1e-12);
    world.remove(held);
    CHECK_FALSE(world.alive(held));
    world.set_velocities(body, std::vector<Vec3>(mesh.nodes.size(), Vec3(0, 1, 0)));
    const Vec3 before = world.center_of_mass(body);
    REQUIRE(world.advance(0.25).ok());
    CHECK((world.center_of_mass(body) - before - Vec3(0, 0.25, 0)).norm() < 1e-12);
}

TEST_CASE("an element that one step would throw inside out is stopped by its own stiffness in shorter ones",
          "[scene]") {
    // the step would otherwise be refused for its speed
    World world = tuned_world({.gravity = Vec3::Zero()}, {.max_strain_step = 100});
    const auto body =
        world.add_body({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}},
                       {.material = world.add_material({.young_modulus = 1e5}), .contact_distance = {}, .name = "tet"});
    const Real h = world.stable_step();
    std::vector<Vec3> velocity(4, Vec3::Zero());
    velocity[3] = {0, 0, -1.05 / h};  // 5 % beyond the opposite face
    world.set_velocities(body, velocity);
    const StepReport report = world.advance(h * (1 - 1e-12));
    CHECK(report.ok());
    CHECK(report.shortened == 1);
    CHECK(report.inverted == 0);
    CHECK(world.report().worst_volume_ratio > 0);
}

TEST_CASE("an element that is pressed inside out is reported with its body, and the step is taken", "[scene]") {
    World world(Settings{.gravity = Vec3::Zero()});
    const auto material = world.add_material({.young_modulus = 1e5});
    world.add_body(mesh::box({1, 1, 1}, {1, 1, 1}),
                   {.material = material, .position = {5, 0, 0}, .contact_distance = {}});
    const auto body = world.add_body({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}},
                                     {.material = material, .name = "tet"});
    const std::array<Index, 3> ground{0, 1, 2};
    const std::array<Index, 1> apex{3};
    world.attach(body, ground, Motion{});
    Motion down;
    down.keys = {{0, {0, 0, 1}, Vec3::Zero()}, {1, {0, 0, -1}, Vec3::Zero()}};
    world.attach(body, apex, down);
    const StepReport report = world.advance(1);
    CHECK(report.ok());
    CHECK(report.inverted == 1);
    CHECK(report.inverted_body == body);
    CHECK(report.inverted_element == 0);
    CHECK_THAT(report.warning(), Catch::Contains("inverted elements: 1, the first of them element 0 of body 'tet'"));
    CHECK(report.shortened >= 2);  // down to a quarter of the stable step, then the inversion is accepted
    CHECK(world.report().inversions == 1);
    CHECK(world.report().inverted == 1);
    CHECK(world.advance(0.1).inverted == 0);  // an element that stays inverted is not reported again
}

TEST_CASE("a push out of a step that was refused is not made in a later one", "[scene]") {
    World world(Settings{.gravity = Vec3::Zero(), .start_overlaps = StartOverlaps::ignore});
    const auto material = world.add_material({.young_modulus = 1e5});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto body = world.add_body(mesh, {.material = material});
    const auto other = world.add_body(mesh, {.material = material, .position = {0.01, 0.005, 0.095}});  // overlaps
    std::vector<Vec3> velocity(mesh.nodes.size(), Vec3::Zero());
    velocity[0] = {0, 0, -1e9};  // faster than any step allows
    world.set_velocities(other, velocity);
    const StepReport refused = world.advance(1e-3);
    REQUIRE(refused.status == StepStatus::too_fast);
    const auto tetrahedron = world.tetrahedra(other)[static_cast<std::size_t>(refused.element)];
    CHECK(std::ranges::find(tetrahedron, refused.node) != tetrahedron.end());
    CHECK_THAT(refused.message(), Catch::Contains(", element " + std::to_string(refused.element) + " would deform by"));
    world.remove(other);
    const std::vector<Vec3> before(world.positions(body).begin(), world.positions(body).end());
    REQUIRE(world.advance(1e-3).ok());
    Real moved = 0;
    for (std::size_t n = 0; n < before.size(); ++n)
        moved = std::max(moved, (world.positions(body)[n] - before[n]).norm());
    CHECK(moved < 1e-14);
}

TEST_CASE("a mesh collider that goes leaves bodies and attachments that came after it where they were", "[scene]") {
    World world(Settings{.gravity = Vec3::Zero()});
    const auto material = world.add_material({.young_modulus = 1e5});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto collider = world.add_collider(
        SurfaceMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}},
        {.position = {5, 0, 0}});
    const auto body = world.add_body(mesh, {.material = material});
    const std::array<Index, 3> some{0, 1, 2};
    const std::array<Index, 1> other{5};
    const auto held = world.attach(body, some, Motion{});
    const auto led = world.attach(body, other, Motion{.velocity = {0, 0, 0.1}});
    world.remove(collider);
    REQUIRE(world.positions(body).size() == mesh.nodes.size());
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) CHECK(world.positions(body)[n] == mesh.nodes[n]);
    world.remove(held);
    REQUIRE(world.alive(led));
    const Real before = world.positions(body)[5].z();
    REQUIRE(world.advance(0.01).ok());
    CHECK(world.positions(body)[5].z() - before == Approx(0.001));
    world.remove(led);
    CHECK(world.advance(0.01).ok());
}

}  // namespace skerry::test::scene_motion_test
