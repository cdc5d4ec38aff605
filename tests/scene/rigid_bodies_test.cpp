// Rigid bodies in whole steps (docs/methods/rigid_bodies.md).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/same_bits.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::rigid_bodies_test {

namespace {

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});

struct RigidCube {
    World world;
    MaterialHandle material;
    BodyHandle body;

    explicit RigidCube(const Settings& settings, BodySettings body_settings = {}, const MaterialSettings& of = {},
                       const Mesh& mesh = cube)
        : world(settings), material(world.add_material(of)) {
        body_settings.material = material;
        body_settings.dynamics = BodyDynamics::rigid;
        body = world.add_body(mesh, body_settings);
    }
};

/// Largest change of the distance between two nodes [m]
Real strain(std::span<const Vec3> position, const Mesh& mesh) {
    Real most = 0;
    for (std::size_t n = 1; n < position.size(); ++n)
        most = std::max(most, std::abs((position[n] - position[0]).norm() - (mesh.nodes[n] - mesh.nodes[0]).norm()));
    return most;
}

/// A rigid block at rest on a plane tilted by `degrees`.
RigidCube on_incline(Real degrees, Real mu, Real h) {
    Settings settings = accurate(tilted_gravity(degrees), 1e-10);
    settings.step_size = h;
    RigidCube scene(settings, {.position = {0, 0, 0.025}, .contact_distance = 0}, {.friction = mu},
                    mesh::box({0.1, 0.1, 0.05}, {2, 2, 1}));
    scene.world.add_collider(Plane{});
    return scene;
}

}  // namespace

TEST_CASE("a free rigid body keeps its momenta and its shape", "[scene][rigid]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = 1.0 / 60;
    const Mesh brick = mesh::box({0.1, 0.2, 0.3}, {1, 2, 3});
    RigidCube scene(settings, {.velocity = {0.1, 0.2, 0.3}, .angular_velocity = {0.2, 6, 0.3}}, {}, brick);
    const WorldReport before = scene.world.report();
    REQUIRE(scene.world.advance(20).ok());
    const WorldReport after = scene.world.report();
    CHECK((after.momentum - before.momentum).norm() < 1e-14 * before.momentum.norm());
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-12 * before.angular_momentum.norm());
    CHECK(std::abs(after.energy.kinetic / before.energy.kinetic - 1) < 1e-3);
    CHECK(strain(scene.world.positions(scene.body), brick) < 1e-14);
    // A solid brick with the density of water. The axis of the middle moment is y.
    const Real mass = 6;
    CHECK(before.momentum.z() == Approx(0.3 * mass).epsilon(1e-12));
    CHECK(before.angular_momentum.y() == Approx(6 * mass * (0.01 + 0.09) / 12).epsilon(1e-12));
}

TEST_CASE("a rigid body falls as the discrete law says", "[scene][rigid]") {
    Settings settings;
    settings.step_size = 1.0 / 128;
    RigidCube scene(settings);
    REQUIRE(scene.world.advance(0.5).steps == 64);
    const Real t = 0.5, h = 1.0 / 128;
    CHECK(scene.world.center_of_mass(scene.body).z() == Approx(-standard_gravity * t * (t + h) / 2).epsilon(1e-12));
}

TEST_CASE("a load on a node of a rigid body moves and turns it", "[scene][rigid]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = 1e-3;
    RigidCube scene(settings);
    std::vector<Vec3> load(cube.nodes.size(), Vec3::Zero());
    std::size_t corner = 0;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n)
        if (cube.nodes[n].sum() > cube.nodes[corner].sum()) corner = n;
    load[corner] = {0, 0, 2};
    scene.world.set_loads(scene.body, load);
    REQUIRE(scene.world.advance(1e-3).ok());
    const WorldReport report = scene.world.report();
    CHECK((report.momentum - Vec3(0, 0, 2e-3)).norm() < 1e-15);
    const Vec3 moment = 1e-3 * cube.nodes[corner].cross(load[corner]);
    CHECK((report.angular_momentum - moment).norm() < 1e-15);
    // The cube has 1 kg and edges of 0.1 m.
    const Vec3 spin = moment / (0.01 / 6);
    const auto n = corner;
    CHECK((scene.world.velocities(scene.body)[n] - (Vec3(0, 0, 2e-3) + spin.cross(cube.nodes[n]))).norm() < 1e-5);
}

TEST_CASE("a rigid block stands below the friction angle without creep, and slides above it by the law",
          "[scene][rigid]") {
    const Real mu = 0.3, critical = std::atan(mu) * 180 / std::numbers::pi;
    for (const Real h : {1.0 / 60, 1.0 / 1000}) {
        RigidCube still = on_incline(critical - 0.1, mu, h);
        REQUIRE(still.world.advance(1).ok());
        const Vec3 start = still.world.center_of_mass(still.body);
        REQUIRE(still.world.advance(1).ok());
        CHECK((still.world.center_of_mass(still.body) - start).norm() < 1e-9);

        RigidCube slides = on_incline(critical + 0.1, mu, h);
        const auto speed = [&] { return slides.world.velocities(slides.body)[0].x(); };
        REQUIRE(slides.world.advance(1).ok());
        const Real before = speed();
        REQUIRE(slides.world.advance(1).ok());
        const Real angle = (critical + 0.1) * std::numbers::pi / 180;
        const Real expected = standard_gravity * (std::sin(angle) - mu * std::cos(angle));
        CHECK(speed() - before == Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("a heavy rigid body on a light one rests on the floor with the weight of both", "[scene][rigid][long]") {
    Settings settings = accurate();
    settings.step_size = 1.0 / 120;
    World world(settings);
    const auto light = world.add_material({.density = 10}), heavy = world.add_material({.density = 1e5});
    const auto lower =
        world.add_body(cube, {.material = light, .position = {0, 0, 0.0501}, .dynamics = BodyDynamics::rigid});
    world.add_body(cube, {.material = heavy, .position = {0, 0, 0.1521}, .dynamics = BodyDynamics::rigid});
    world.add_collider(Plane{});
    REQUIRE(world.advance(2).ok());
    Real floor = 0;
    for (const Contact& contact : world.contacts())
        if (contact.second == BodyHandle{}) floor += contact.impulse.z();
    const Real weight = (0.01 + 100) * standard_gravity;
    CHECK(floor / (1.0 / 120) == Approx(weight).epsilon(1e-3));
    CHECK(world.center_of_mass(lower).z() > 0.0499);
    CHECK(world.report().momentum_error_share < 1e-9);
}

TEST_CASE("a rigid body exchanges momentum with one that deforms", "[scene][rigid]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto soft = world.add_material({.young_modulus = 1e5}), hard = world.add_material({.density = 3000});
    world.add_body(cube, {.material = soft, .position = {0, 0, 0}});
    world.add_body(cube, {.material = hard,
                          .position = {0.03, 0.01, 0.2},
                          .rotation = {0.3, 0.2, 0.1},
                          .velocity = {0, 0, -2},
                          .dynamics = BodyDynamics::rigid});
    const WorldReport before = world.report();
    REQUIRE(world.advance(0.3).ok());
    const WorldReport after = world.report();
    CHECK(after.mean_contacts > 0);
    CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 2e-3 * before.momentum.norm() * 0.1);
    CHECK(after.energy_error < 0.01 * before.energy.kinetic);
}

TEST_CASE("a world with rigid bodies goes on bit by bit when it is cloned or saved, on any number of workers",
          "[scene][rigid]") {
    const auto simulate = [](int threads) {
        Settings settings;
        settings.threads = threads;
        World world(settings);
        const auto material = world.add_material({.young_modulus = 2e5});
        for (int k = 0; k < 6; ++k)
            world.add_body(cube, {.material = material,
                                  .position = {0.02 * k, 0.015 * k, 0.08 + 0.13 * k},
                                  .rotation = {0.2 * k, 0.1, 0.3},
                                  .angular_velocity = {0.1, 1.0 * k, -0.3},
                                  .dynamics = k % 2 == 0 ? BodyDynamics::rigid : BodyDynamics::explicit_elastic});
        world.add_collider(Plane{});
        REQUIRE(world.advance(0.4).ok());
        return world;
    };
    check_same_bits(
        simulate, [](World& world) { REQUIRE(world.advance(0.3).ok()); }, 4);
}

TEST_CASE("a rigid body that is set by hand stays rigid", "[scene][rigid]") {
    RigidCube scene{Settings{}};
    std::vector<Vec3> position(cube.nodes.size()), velocity(cube.nodes.size());
    const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (std::size_t n = 0; n < position.size(); ++n) {
        position[n] = Vec3(1, 2, 3) + turn * cube.nodes[n];
        velocity[n] = Vec3(0.1, 0, 0) + Vec3(0, 0, 2).cross(position[n] - Vec3(1, 2, 3));
    }
    scene.world.set_positions(scene.body, position);
    scene.world.set_velocities(scene.body, velocity);
    CHECK((scene.world.center_of_mass(scene.body) - Vec3(1, 2, 3)).norm() < 1e-14);
    for (std::size_t n = 0; n < position.size(); ++n) {
        CHECK((scene.world.positions(scene.body)[n] - position[n]).norm() < 1e-14);
        CHECK((scene.world.velocities(scene.body)[n] - velocity[n]).norm() < 1e-13);
    }
    CHECK(scene.world.report().angular_momentum.z() ==
          Approx(2 * 0.01 / 6 + Vec3(1, 2, 3).cross(Vec3(0.1, 0, 0)).z()).epsilon(1e-12));
    position[3].x() += 0.01;
    CHECK_THROWS_WITH(scene.world.set_positions(scene.body, position),
                      Catch::Matchers::Contains("the shape of the rigid body, translated and rotated as a whole"));
    CHECK((scene.world.positions(scene.body)[3] - position[3]).norm() > 0.009);
}

TEST_CASE("bodies are posed and thrown as a whole", "[scene][rigid]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    for (const BodyDynamics dynamics : {BodyDynamics::rigid, BodyDynamics::explicit_elastic}) {
        const auto body = world.add_body(
            cube, {.material = material, .position = {1, 2, 3}, .rotation = {0.3, 0, 0.2}, .dynamics = dynamics});
        CHECK(world.dynamics(body) == dynamics);
        CHECK((world.pose(body).position - Vec3(1, 2, 3)).norm() < 1e-13);
        CHECK((world.pose(body).rotation - Vec3(0.3, 0, 0.2)).norm() < 1e-13);
        const Pose there{{-1, 0, 2}, {0.5, -0.4, 0.1}};
        world.set_pose(body, there);
        world.set_velocity(body, {1, 0, 0}, {0, 2, 0});
        CHECK((world.pose(body).position - there.position).norm() < 1e-13);
        CHECK((world.pose(body).rotation - there.rotation).norm() < 1e-13);
        const Mat3 turn = Eigen::AngleAxis<Real>(there.rotation.norm(), there.rotation.normalized()).toRotationMatrix();
        for (std::size_t n = 0; n < cube.nodes.size(); ++n) {
            const Vec3 arm = turn * cube.nodes[n];
            CHECK((world.positions(body)[n] - (there.position + arm)).norm() < 1e-13);
            CHECK((world.velocities(body)[n] - (Vec3(1, 0, 0) + Vec3(0, 2, 0).cross(arm))).norm() < 1e-13);
        }
        CHECK_THROWS_AS(world.set_pose(body, {{NAN, 0, 0}, {}}), SceneError);
        CHECK_THROWS_AS(world.set_velocity(body, {NAN, 0, 0}), SceneError);
        world.remove(body);
    }
}

TEST_CASE("settings that rigid bodies do not support are refused by name", "[scene][rigid]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto body = world.add_body(cube, {.material = material, .name = "wrench"});
    const std::vector<Index> nodes{0};
    CHECK_NOTHROW(world.attach(body, nodes));
    CHECK_THROWS_WITH(
        world.add_body(cube, {.material = material, .self_contact = true, .dynamics = BodyDynamics::rigid}),
        Catch::Matchers::Contains("self_contact"));
}

TEST_CASE("a rigid body of several materials has the mass and the inertia of all", "[scene][rigid]") {
    // Two cubes side by side in one mesh
    constexpr Real side = 0.1, light = 1000, heavy = 3000, turn = 2;
    Mesh bar = mesh::box({2 * side, side, side}, {4, 2, 2});
    for (const auto& tetrahedron : bar.tetrahedra) {
        Real along = 0;
        for (const Index node : tetrahedron) along += bar.nodes[static_cast<std::size_t>(node)].x() / 4;
        bar.label.push_back(along > 0 ? 1 : 0);
    }
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto one = world.add_material({.density = light}), other = world.add_material({.density = heavy});
    const auto body = world.add_body(bar, {.material = one,
                                           .materials = {{1, other}},
                                           .angular_velocity = {0, 0, turn},
                                           .dynamics = BodyDynamics::rigid});
    const auto energy_of = [&](Real of_light, Real of_heavy) {
        const Real volume = side * side * side, m1 = of_light * volume, m2 = of_heavy * volume;
        const Real reduced = m1 * m2 / (m1 + m2);
        return ((m1 + m2) * side * side / 6 + reduced * side * side) * turn * turn / 2;
    };
    CHECK(world.report().energy.kinetic == Approx(energy_of(light, heavy)).epsilon(1e-12));
    CHECK(world.report().momentum.norm() < 1e-14);
    const Vec3 center(side / 2 * (heavy - light) / (heavy + light), 0, 0);
    for (std::size_t n = 0; n < bar.nodes.size(); ++n)
        CHECK((world.velocities(body)[n] - Vec3(0, 0, turn).cross(bar.nodes[n] - center)).norm() < 1e-15);

    const TemporaryFolder folder;
    world.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world");
    World copy = world.clone();
    for (World* each : {&world, &loaded, &copy}) {
        // Changes one of the two materials. The body keeps its velocity.
        each->set_material(other, {.density = 5 * light});
        CHECK(each->report().energy.kinetic == Approx(energy_of(light, 5 * light)).epsilon(1e-12));
        REQUIRE(each->advance(0.1).ok());
    }
    CHECK(loaded.state_hash() == world.state_hash());
    CHECK(copy.state_hash() == world.state_hash());
}

TEST_CASE("a rigid body comes to rest, sleeps, and wakes when it is hit", "[scene][rigid]") {
    Settings settings;
    settings.sleep = true;
    RigidCube scene(settings, {.position = {0, 0, 0.0501}});
    scene.world.add_collider(Plane{});
    REQUIRE(scene.world.advance(2).ok());
    CHECK(scene.world.asleep(scene.body));
    const Vec3 rested = scene.world.center_of_mass(scene.body);
    const auto hit = scene.world.add_body(cube, {.material = scene.material,
                                                 .position = {0.3, 0, 0.06},
                                                 .velocity = {-3, 0, 0},
                                                 .dynamics = BodyDynamics::rigid});
    REQUIRE(scene.world.advance(0.2).ok());
    CHECK(scene.world.center_of_mass(scene.body).x() < rested.x() - 0.01);
    CHECK(scene.world.center_of_mass(hit).x() > scene.world.center_of_mass(scene.body).x());
    CHECK(scene.world.report().energy_error < 1e-9);
}

TEST_CASE("rows of rigid bodies follow when others go", "[scene][rigid]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto material = world.add_material({});
    const auto first = world.add_body(cube, {.material = material, .dynamics = BodyDynamics::rigid});
    world.add_body(cube, {.material = material, .position = {1, 0, 0}});
    const auto last = world.add_body(cube, {.material = material,
                                            .position = {2, 0, 0},
                                            .velocity = {0, 1, 0},
                                            .angular_velocity = {0, 0, 3},
                                            .dynamics = BodyDynamics::rigid});
    world.remove(first);
    REQUIRE(world.advance(0.5).ok());
    CHECK((world.center_of_mass(last) - Vec3(2, 0.5, 0)).norm() < 1e-12);
    CHECK(world.report().angular_momentum.z() == Approx(3 * 0.01 / 6 + 2).epsilon(1e-12));
}

TEST_CASE("leapfrog moves rigid bodies to second order", "[scene][rigid]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    settings.step_size = 1.0 / 64;
    RigidCube scene(settings, {.velocity = {0, 0, 1}, .angular_velocity = {1, 5, 2}});
    REQUIRE(scene.world.advance(0.5).ok());
    CHECK(scene.world.center_of_mass(scene.body).z() == Approx(0.5 - standard_gravity / 8).epsilon(1e-12));
    CHECK(strain(scene.world.positions(scene.body), cube) < 1e-14);
}

}  // namespace skerry::test::rigid_bodies_test
