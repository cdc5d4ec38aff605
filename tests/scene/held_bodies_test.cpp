// Rigid bodies that attachments hold and move (docs/methods/rigid_bodies.md 5).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::held_bodies_test {

namespace {

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
const Real cube_mass = 1;  // with the density of water [kg]

/// Nodes at three corners of the cube.
const std::vector<Index> corners{0, 2, 6};

/// A cube that is moved and turned by an attachment, and a body that falls onto it.
struct LedCube {
    World world;
    MaterialHandle material;
    BodyHandle led, falls;
    AttachmentHandle attachment;

    explicit LedCube(Settings settings = {}, BodyDynamics falling = BodyDynamics::rigid,
                     const Motion& motion = {.velocity = {0.1, 0, 0.05}, .angular_velocity = {0, 0, 0.5}})
        : world(settings), material(world.add_material({.young_modulus = 2e5, .friction = 0.4})) {
        led = world.add_body(cube, {.material = material, .dynamics = BodyDynamics::rigid});
        falls = world.add_body(
            cube,
            {.material = material, .position = {0.02, 0.01, 0.12}, .rotation = {0.1, 0.2, 0}, .dynamics = falling});
        attachment = world.attach(led, corners, motion);
    }
};

Mat3 turn_by(const Vec3& rotation) {
    const Real angle = rotation.norm();
    return angle == 0 ? Mat3(Mat3::Identity()) : Eigen::AngleAxis<Real>(angle, rotation / angle).toRotationMatrix();
}

}  // namespace

TEST_CASE("a rigid body that is held stands still whatever falls on it, and the attachment carries both",
          "[scene][rigid]") {
    Settings settings = accurate();
    settings.step_size = 1.0 / 120;
    LedCube scene(settings, BodyDynamics::rigid, {});
    const std::vector<Vec3> start(scene.world.positions(scene.led).begin(), scene.world.positions(scene.led).end());
    REQUIRE(scene.world.advance(3).ok());
    const auto now = scene.world.positions(scene.led);
    for (std::size_t n = 0; n < start.size(); ++n) CHECK((now[n] - start[n]).norm() < 1e-16);
    CHECK(scene.world.center_of_mass(scene.falls).z() > 0.099);
    scene.world.measure_forces(true);
    REQUIRE(scene.world.advance(0.5).ok());
    const ForceReport reaction = scene.world.forces().by(scene.attachment);
    CHECK(reaction.force().z() == Approx(2 * cube_mass * standard_gravity).epsilon(1e-4));
    const Vec3 arm = scene.world.center_of_mass(scene.falls);  // lever arm of the falling cube's weight
    CHECK((reaction.moment() - arm.cross(Vec3(0, 0, cube_mass * standard_gravity))).norm() < 1e-3);
}

TEST_CASE("a rigid body that is led goes where the attachment goes, and goes on alone when it is let go",
          "[scene][rigid]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.integrator = integrator;
        World world(settings);
        const auto material = world.add_material({});
        const Vec3 at(0.5, 0.2, 0.1), velocity(0.2, -0.1, 0.3), turning(0.3, 1, -2), pivot(0.1, 0, 0);
        const auto body = world.add_body(cube, {.material = material, .position = at, .dynamics = BodyDynamics::rigid});
        const auto hand = world.attach(body, corners, {.velocity = velocity, .angular_velocity = turning}, pivot);
        REQUIRE(world.advance(0.7).ok());
        const Mat3 turn = turn_by(0.7 * turning);
        const auto now = world.positions(body);
        for (std::size_t n = 0; n < cube.nodes.size(); ++n)
            CHECK((now[n] - (pivot + 0.7 * velocity + turn * (at + cube.nodes[n] - pivot))).norm() < 1e-13);
        world.remove(hand);
        const Vec3 center = world.center_of_mass(body);
        const WorldReport let_go = world.report();
        CHECK((let_go.momentum / cube_mass - velocity - turning.cross(turn * (at - pivot))).norm() < 0.02);
        REQUIRE(world.advance(0.5).ok());
        CHECK((world.center_of_mass(body) - center - 0.5 / cube_mass * let_go.momentum).norm() < 1e-13);
        CHECK((world.report().angular_momentum - let_go.angular_momentum).norm() < 1e-13);
    }
}

TEST_CASE("the reaction of an attachment is the impulse on its rigid body, less all other impulses", "[scene][rigid]") {
    Settings settings;
    settings.step_size = 1.0 / 250;
    World world(settings);
    const auto material = world.add_material({});
    const auto body = world.add_body(
        mesh::box({0.1, 0.2, 0.3}, {1, 2, 3}),
        {.material = material, .position = {0.3, 0, 0}, .rotation = {0.2, 0.1, 0.4}, .dynamics = BodyDynamics::rigid});
    const auto hand = world.attach(
        body, std::vector<Index>{0, 1, 2, 4},
        {.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {0.5, {0.1, 0, 0}, {0.5, 1, 0}}, {1, {0.1, 0.2, 0}, {0.5, 1, 2}}}});
    std::vector<Vec3> load(world.positions(body).size(), Vec3::Zero());
    load[3] = {0, 4, 1};
    world.set_loads(body, load);
    const Vec3 about(0.1, -0.2, 0.3);
    world.measure_forces(true, about);
    REQUIRE(world.advance(0.1).ok());
    const auto motion = [&] {
        const WorldReport report = world.report();
        return std::pair(report.momentum, Vec3(report.angular_momentum - about.cross(report.momentum)));
    };
    for (const Real seconds : {0.3, 0.6}) {
        const auto [momentum, angular] = motion();
        Vec3 loads = Vec3::Zero(), moments = Vec3::Zero();
        const Vec3 weight(0, 0, -world.mass(body) * standard_gravity);
        // Forces act at the position of the body at the start of each step.
        world.watch_steps([&, seen = std::pair(world.center_of_mass(body), Vec3(world.positions(body)[3]))](
                              const StepReport&) mutable {
            loads += settings.step_size.value() * (weight + load[3]);
            moments += settings.step_size.value() *
                       ((seen.first - about).cross(weight) + (seen.second - about).cross(load[3]));
            seen = {world.center_of_mass(body), world.positions(body)[3]};
        });
        REQUIRE(world.advance(seconds).ok());
        world.watch_steps({});
        const auto [momentum_next, angular_next] = motion();
        const ForceReport reaction = world.forces().by(hand);
        CHECK((reaction.impulse - (momentum_next - momentum - loads)).norm() < 1e-12);
        CHECK((reaction.moment_impulse - (angular_next - angular - moments)).norm() < 1e-12);
        CHECK(reaction.impulse.norm() > 1);
    }
}

TEST_CASE("a rigid body that is led into others acts like a collider with its mesh", "[scene][rigid]") {
    const auto pushed = [](bool attached) {
        World world(accurate({0, 0, 0}));
        const auto material = world.add_material({.young_modulus = 1e5, .friction = 0.3});
        const Motion motion{.velocity = {0.5, 0, 0}, .angular_velocity = {0, 0, 1}};
        if (attached)
            world.attach(world.add_body(
                             cube, {.material = material, .contact_distance = 0.002, .dynamics = BodyDynamics::rigid}),
                         corners, motion);
        else
            world.add_collider(mesh::boundary(cube), {.motion = motion, .contact_distance = 0.002});
        const auto body =
            world.add_body(cube, {.material = material, .position = {0.13, 0.02, 0.01}, .contact_distance = 0.002});
        REQUIRE(world.advance(0.3).ok());
        return world.center_of_mass(body);
    };
    const Vec3 by_body = pushed(true), by_collider = pushed(false);
    CHECK(by_body.x() > 0.2);
    // Other numbers of nodes and triangles give another order of contacts.
    CHECK((by_body - by_collider).norm() < 2e-3 * (by_collider - Vec3(0.13, 0.02, 0.01)).norm());
}

TEST_CASE("momentum and energy add up where rigid bodies are led", "[scene][rigid]") {
    for (const BodyDynamics falling : {BodyDynamics::rigid, BodyDynamics::explicit_elastic}) {
        LedCube scene({}, falling);
        REQUIRE(scene.world.advance(0.5).ok());
        const WorldReport report = scene.world.report();
        REQUIRE(report.mean_contacts > 1);
        CHECK(report.balanced_steps == report.steps);
        CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
        CHECK(report.energy_error_share < 5e-3);
    }
}

TEST_CASE("a world with held rigid bodies goes on bit by bit when it is cloned or saved, on any number of workers",
          "[scene][rigid]") {
    const auto make = [](int threads) {
        Settings settings;
        settings.threads = threads;
        return LedCube(settings, BodyDynamics::explicit_elastic);
    };
    LedCube one = make(1), four = make(4);
    REQUIRE(one.world.advance(0.3).ok());
    REQUIRE(four.world.advance(0.3).ok());
    CHECK(one.world.state_hash() == four.world.state_hash());
    World copy = one.world.clone();
    const TemporaryFolder folder;
    one.world.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world");
    for (World* world : {&one.world, &copy, &loaded}) {
        world->set_material(one.material, {.young_modulus = 2e5, .density = 2000});
        REQUIRE(world->advance(0.2).ok());
    }
    CHECK(copy.state_hash() == one.world.state_hash());
    CHECK(loaded.state_hash() == one.world.state_hash());
}

TEST_CASE("held rigid bodies move with their attachments when they are put elsewhere", "[scene][rigid]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto gone = world.add_body(cube, {.material = material, .position = {-1, 0, 0}});
    const auto body = world.add_body(cube, {.material = material, .dynamics = BodyDynamics::rigid});
    const auto first = world.attach(body, corners, {}, {0.1, 0, 0});
    const auto second = world.attach(body, corners);
    world.remove(gone);
    const auto is_at = [&](const Pose& pose) {
        REQUIRE(world.advance(0.05).ok());
        CHECK((world.pose(body).position - pose.position).norm() < 1e-13);
        CHECK((world.pose(body).rotation - pose.rotation).norm() < 1e-13);
    };
    is_at({});
    world.set_pose(second, {{1, 2, 3}, {0.4, 0, 0}});
    is_at({{1, 2, 3}, {0.4, 0, 0}});
    world.set_pose(body, {{0, 0, 1}, {0, 0.3, 0}});
    is_at({{0, 0, 1}, {0, 0.3, 0}});
    world.move_to(second, {{1, 2, 4}, {0.4, 0, 0}}, 0.05);
    is_at({{0, 0, 2}, world.pose(body).rotation});  // moved by 1 m along z
    // The remaining attachment holds the body at the pose that was set last.
    world.remove(second);
    is_at({{0, 0, 1}, {0, 0.3, 0}});
    world.remove(first);
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.pose(body).position.z() < 0.99);
}

TEST_CASE("held rigid bodies rest, and wake when they are led", "[scene][rigid]") {
    Settings settings;
    settings.sleep = true;
    LedCube scene(settings, BodyDynamics::rigid, {});
    REQUIRE(scene.world.advance(4).ok());
    CHECK(scene.world.asleep(scene.led));
    CHECK(scene.world.asleep(scene.falls));
    const Vec3 rested = scene.world.center_of_mass(scene.falls);
    scene.world.set_velocity(scene.attachment, {0, 0, 0.3});
    REQUIRE(scene.world.advance(0.2).ok());
    CHECK(scene.world.center_of_mass(scene.led).z() == Approx(0.06).epsilon(1e-12));
    CHECK(scene.world.center_of_mass(scene.falls).z() == Approx(rested.z() + 0.06).margin(2e-3));
}

TEST_CASE("nodes that do not hold a rigid body as a whole are refused", "[scene][rigid]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto nut = world.add_body(cube, {.material = material, .dynamics = BodyDynamics::rigid, .name = "nut"});
    std::vector<Index> edge;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n)
        if (cube.nodes[n].x() < -0.049 && cube.nodes[n].y() < -0.049) edge.push_back(static_cast<Index>(n));
    REQUIRE(edge.size() == 3);
    CHECK_THROWS_WITH(world.attach(nut, {}), "attach: nodes: found no nodes, expected at least one node of the body");
    for (const std::vector<Index>& nodes : {std::vector<Index>{0}, {0, 2}, edge, {0, 2, 0, 2}})
        CHECK_THROWS_WITH(world.attach(nut, nodes), Catch::Matchers::Contains("the rigid body 'nut'"));
    edge.push_back(static_cast<Index>(cube.nodes.size()) - 1);
    CHECK_NOTHROW(world.attach(nut, edge));
}

}  // namespace skerry::test::held_bodies_test
