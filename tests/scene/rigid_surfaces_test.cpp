// Rigid bodies without tetrahedra, and rigid bodies with given mass properties (docs/methods/rigid_bodies.md).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <string>

#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/scene.h"
#include "skerry/spring.h"
#include "tests/support/same_bits.h"
#include "tests/support/surface_corpus.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::rigid_surfaces_test {

namespace {

using Catch::Matchers::Contains;

const Vec3 brick_size{0.1, 0.2, 0.3};
const SurfaceMesh brick = mesh::boundary(mesh::box(brick_size, {1, 1, 1}));

Settings weightless(Real h = 1.0 / 60) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = h;
    return settings;
}

struct OneBody {
    World world;
    MaterialHandle material;
    BodyHandle body;

    OneBody(const Settings& settings, const auto& shape, BodySettings body_settings = {},
            const MaterialSettings& made_of = {})
        : world(settings), material(world.add_material(made_of)) {
        body_settings.material = material;
        body_settings.dynamics = BodyDynamics::rigid;
        body = world.add_body(shape, body_settings);
    }

    /// Inertia tensor about the centre of mass in world axes, from the angular momenta of three spins [kg m^2].
    Mat3 inertia() {
        Mat3 found;
        const Vec3 velocity = world.velocity(body).velocity, spin = world.velocity(body).angular_velocity;
        for (int axis = 0; axis < 3; ++axis) {
            world.set_velocity(body, Vec3::Zero(), Vec3::Unit(axis));
            found.col(axis) = world.report().angular_momentum;
        }
        world.set_velocity(body, velocity, spin);
        return found;
    }
};

Mat3 inertia_of_box(Real mass, const Vec3& size) {
    const Vec3 squares = size.cwiseProduct(size) * mass / 12;
    return Vec3(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y()).asDiagonal();
}

/// Mass properties of a robot link whose centre of mass is outside of its shape.
BodySettings link_settings() {
    Mat3 inertia;
    inertia << 0.03, 0.004, -0.002, 0.004, 0.05, 0.001, -0.002, 0.001, 0.04;
    return {.mass = 2.5, .center_of_mass = Vec3(0.12, -0.05, 0.4), .inertia = inertia};
}

}  // namespace

TEST_CASE("a body of a surface has the mass, the centre and the inertia of the solid inside", "[scene][rigid]") {
    const Vec3 by{3, -2, 5};
    OneBody box(weightless(), moved(brick, by), {}, {.density = 700});
    const Real mass = 700 * brick_size.prod();
    CHECK(box.world.mass(box.body) == Approx(mass).epsilon(1e-12));
    CHECK((box.world.center_of_mass(box.body) - by).norm() < 1e-12);
    CHECK((box.inertia() - inertia_of_box(mass, brick_size)).norm() < 1e-12);

    // A void in the box, bounded by a shell that is inside out.
    const SurfaceMesh core = turned_inside_out(mesh::boundary(mesh::box(brick_size / 2, {1, 1, 1})));
    OneBody hollow(weightless(), both(brick, core), {}, {.density = 700});
    CHECK(hollow.world.mass(hollow.body) == Approx(mass * 7 / 8).epsilon(1e-12));
    CHECK((hollow.inertia() - inertia_of_box(mass, brick_size) * 31 / 32).norm() < 1e-12);

    Mesh ellipsoid = mesh::ball(1, 16);
    const Vec3 axes{0.1, 0.2, 0.3};
    for (Vec3& x : ellipsoid.nodes) x = x.cwiseProduct(axes);
    OneBody solid(weightless(), ellipsoid), shell(weightless(), mesh::boundary(ellipsoid));
    CHECK(shell.world.mass(shell.body) == Approx(solid.world.mass(solid.body)).epsilon(1e-12));
    CHECK((shell.inertia() - solid.inertia()).norm() < 1e-12 * solid.inertia().norm());
    // The facets are inside the ellipsoid. Their distance falls with the square of their size.
    const Real exact = 1000 * 4 * std::numbers::pi / 3 * axes.prod();
    CHECK(shell.world.mass(shell.body) == Approx(exact).epsilon(0.02));
    const Mat3 of_ellipsoid = inertia_of_box(exact, 2 * axes) * 12 / 20;
    CHECK((shell.inertia() - of_ellipsoid).norm() < 0.03 * of_ellipsoid.norm());
}

TEST_CASE("a free body of a surface keeps energy and momenta and turns over about its middle axis", "[scene][rigid]") {
    for (const BodySettings& given : {BodySettings{}, link_settings()}) {
        BodySettings settings = given;
        const Vec3 middle = given.inertia ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
        settings.velocity = {0.1, 0.2, 0.3};
        settings.angular_velocity = 6 * middle + Vec3(0.2, 0.1, 0.2);
        OneBody scene(weightless(1.0 / 240), brick, settings);
        const WorldReport before = scene.world.report();
        const Vec3 start = scene.world.center_of_mass(scene.body);
        Real lowest = 1;
        for (int k = 0; k < 80; ++k) {
            REQUIRE(scene.world.advance(0.1).ok());
            const Vec3 rotation = scene.world.pose(scene.body).rotation;
            const Vec3 axis = Eigen::AngleAxis<Real>(rotation.norm(), rotation.normalized()) * middle;
            lowest = std::min(lowest, axis.dot(middle));
        }
        const WorldReport after = scene.world.report();
        CHECK((after.momentum - before.momentum).norm() < 1e-13 * before.momentum.norm());
        CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-11 * before.angular_momentum.norm());
        CHECK(std::abs(after.energy.kinetic / before.energy.kinetic - 1) < 1e-4);
        CHECK((scene.world.center_of_mass(scene.body) - start - 8 * Vec3(0.1, 0.2, 0.3)).norm() < 1e-11);
        CHECK(lowest < -0.9);
    }
}

TEST_CASE("a box of a surface falls, rests and slides as the box of tetrahedra", "[scene][rigid]") {
    const Mesh box = mesh::box({0.1, 0.1, 0.05}, {2, 2, 1});
    for (const Real degrees : {5.0, 20.0}) {
        Settings settings = accurate(tilted_gravity(degrees), 1e-12);
        settings.step_size = 1.0 / 120;
        const BodySettings start{.position = {0, 0, 0.08}, .rotation = {0, 0.1, 0.05}};
        OneBody solid(settings, box, start, {.friction = 0.2}),
            hollow(settings, mesh::boundary(box), start, {.friction = 0.2});
        for (OneBody* each : {&solid, &hollow}) each->world.add_collider(Plane{});
        for (int k = 0; k < 10; ++k) {
            REQUIRE(solid.world.advance(0.1).ok());
            REQUIRE(hollow.world.advance(0.1).ok());
            CHECK((hollow.world.center_of_mass(hollow.body) - solid.world.center_of_mass(solid.body)).norm() < 1e-9);
        }
        CHECK((solid.world.velocities(solid.body)[0].norm() > 0.1) == (degrees > 10));
        CHECK(hollow.world.report().energy_error < 1e-9);
        CHECK(hollow.world.report().momentum_error_share < 1e-9);
    }
}

TEST_CASE("given mass properties replace those of the shape", "[scene][rigid]") {
    const BodySettings given = link_settings();
    const Vec3 turn{0.3, -0.4, 0.5};
    const Mat3 rotation = Eigen::AngleAxis<Real>(turn.norm(), turn.normalized()).toRotationMatrix();
    const auto check = [&](OneBody scene, bool is_round) {
        World& world = scene.world;
        const Vec3 center = Vec3(1, 2, 3) + rotation * *given.center_of_mass;
        const Mat3 inertia = rotation * *given.inertia * rotation.transpose();
        CHECK(world.mass(scene.body) == Approx(2.5).epsilon(1e-14));
        CHECK((world.center_of_mass(scene.body) - center).norm() < 1e-13);
        CHECK((scene.inertia() - inertia).norm() < 1e-13);
        world.set_material(scene.material, {.density = 5000});  // the given values do not depend on the density
        CHECK((scene.inertia() - inertia).norm() < 1e-13);
        CHECK((world.center_of_mass(scene.body) - center).norm() < 1e-13);
        // All nodes move about the given centre, and velocities that are set by node are read in the same way.
        world.set_velocity(scene.body, {1, 0, 0}, {0, 2, 1});
        std::vector<Vec3> velocity;
        for (const Vec3& x : world.positions(scene.body)) velocity.push_back(Vec3(0, 1, 0) + turn.cross(x - center));
        CHECK((world.velocities(scene.body)[3] - Vec3(1, 0, 0) -
               Vec3(0, 2, 1).cross(world.positions(scene.body)[3] - center))
                  .norm() < 1e-13);
        world.set_velocities(scene.body, velocity);
        CHECK((world.report().momentum - Vec3(0, 2.5, 0)).norm() < 1e-12);
        CHECK((world.report().angular_momentum - center.cross(Vec3(0, 2.5, 0)) - inertia * turn).norm() < 1e-12);
        // Positions that are set by node are a pose of the body.
        std::vector<Vec3> position;
        for (const Vec3& x : world.positions(scene.body)) position.push_back(rotation * (x - center) + center);
        world.set_positions(scene.body, position);
        CHECK((world.center_of_mass(scene.body) - center).norm() < 1e-13);
        CHECK((world.positions(scene.body)[3] - position[3]).norm() < 1e-13);
        // An acceleration of all nodes acts at the centre of mass: it does not turn the body.
        world.set_velocity(scene.body, Vec3::Zero(), Vec3::Zero());
        Loads(world).add(AccelerationField{.acceleration = {0, 0, -4}});
        REQUIRE(world.advance(0.5).ok());
        CHECK(world.velocity(scene.body).angular_velocity.norm() < 1e-12);
        CHECK((world.velocity(scene.body).velocity - Vec3(0, 0, -2)).norm() < 1e-12);
        CHECK(world.report().energy_error < 1e-12);
        if (is_round) return;
        // The nodes are free again after an attachment.
        std::vector<Index> all(world.positions(scene.body).size());
        for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Index>(n);
        const AttachmentHandle pin = world.attach(scene.body, all);
        REQUIRE(world.advance(0.1).ok());
        world.remove(pin);
        REQUIRE(world.advance(0.1).ok());
        CHECK((world.velocity(scene.body).velocity - Vec3(0, 0, -0.4)).norm() < 1e-12);
    };
    BodySettings start = given;
    start.position = {1, 2, 3};
    start.rotation = turn;
    check(OneBody(weightless(), brick, start), false);
    check(OneBody(weightless(), mesh::box(brick_size, {2, 2, 2}), start), false);
    check(OneBody(weightless(), Capsule{0.1, 0.3}, start), true);  // it cannot be attached
}

TEST_CASE("a given mass alone scales the density", "[scene][rigid]") {
    OneBody scene(weightless(), brick, {.mass = 12});
    CHECK(scene.world.mass(scene.body) == Approx(12).epsilon(1e-14));
    CHECK((scene.inertia() - inertia_of_box(12, brick_size)).norm() < 1e-12);
    scene.world.set_material(scene.material, {.density = 200});
    CHECK((scene.inertia() - inertia_of_box(12, brick_size)).norm() < 1e-12);
}

TEST_CASE("a link of overlapping shells touches with all of them", "[scene][rigid]") {
    // Two bars that cross in the middle, each with corners inside of the other one.
    const SurfaceMesh along = mesh::boundary(mesh::box({0.3, 0.1, 0.1}, {3, 1, 1})),
                      across = mesh::boundary(mesh::box({0.1, 0.3, 0.06}, {1, 3, 1}));
    Settings settings = accurate();
    settings.step_size = 1.0 / 120;
    OneBody link(settings, both(along, across),
                 {.position = {0, 0, 0.06},
                  .contact_distance = 0,
                  .mass = 1,
                  .center_of_mass = Vec3::Zero(),
                  .inertia = Mat3(0.01 * Mat3::Identity())});
    World& world = link.world;
    world.add_collider(Plane{});
    const auto small = [&](const Vec3& position) {
        return world.add_body(
            mesh::box({0.04, 0.04, 0.04}, {1, 1, 1}),
            {.material = link.material, .position = position, .contact_distance = 0, .dynamics = BodyDynamics::rigid});
    };
    // One cube falls onto the middle, where both bars are below it, and two cubes onto the ends of the lower bar.
    const BodyHandle middle = small({0, 0, 0.14});
    const BodyHandle left = small({0, -0.12, 0.12}), right = small({0, 0.12, 0.12});
    REQUIRE(world.advance(1).ok());
    CHECK(world.center_of_mass(link.body).z() == Approx(0.05).margin(1e-4));
    CHECK(world.center_of_mass(middle).z() == Approx(0.12).margin(1e-4));
    for (const BodyHandle each : {left, right})
        CHECK(world.center_of_mass(each).z() == Approx(0.05 + 0.03 + 0.02).margin(1e-4));
    CHECK(world.report().momentum_error_share < 1e-9);
}

TEST_CASE("a rigid body that nothing collides with swings on a joint by its given mass alone", "[scene][rigid]") {
    // A physical pendulum about y with its centre of mass at a distance d below the hinge.
    Settings settings;
    settings.step_size = 1e-3;
    const Real d = 0.4, mass = 2, moment = 0.05, angle = 0.05;
    OneBody link(settings, brick,
                 {.rotation = {0, angle, 0},
                  .mass = mass,
                  .center_of_mass = Vec3(0, 0, -d),
                  .inertia = Mat3(moment * Mat3::Identity()),
                  .collision_mask = 0});
    World& world = link.world;
    world.add_collider(Plane{});  // it goes through the brick
    Joints(world).add({.kind = JointKind::hinge, .first = link.body, .point = Vec3::Zero(), .axis = {0, 1, 0}});
    const Real period = 2 * std::numbers::pi * std::sqrt((moment + mass * d * d) / (mass * standard_gravity * d));
    REQUIRE(world.advance(period / 4).ok());
    CHECK(world.center_of_mass(link.body).x() == Approx(0).margin(0.002 * d * angle + 1e-5));
    REQUIRE(world.advance(period / 4).ok());
    CHECK(world.center_of_mass(link.body).x() == Approx(d * std::sin(angle)).epsilon(0.005));
    CHECK(world.contacts().empty());
}

TEST_CASE("a ball with a low centre of mass rolls back and forth with the period of its given inertia",
          "[scene][rigid]") {
    Settings settings = accurate();
    settings.step_size = 1e-3;
    const Real radius = 0.1, d = 0.03, mass = 1.5, moment = 0.003, angle = 0.05;
    OneBody ball(settings, Sphere{radius},
                 {.position = {0, 0, radius},
                  .rotation = {0, angle, 0},
                  .contact_distance = 0,
                  .mass = mass,
                  .center_of_mass = Vec3(0, 0, -d),
                  .inertia = Mat3(moment * Mat3::Identity())});
    World& world = ball.world;
    world.add_collider(Plane{}, {.friction = 1});
    const Real arm = radius - d;
    const Real period = 2 * std::numbers::pi * std::sqrt((moment + mass * arm * arm) / (mass * standard_gravity * d));
    REQUIRE(world.advance(period / 4).ok());
    CHECK(world.pose(ball.body).rotation.y() == Approx(0).margin(0.02 * angle));
    REQUIRE(world.advance(period / 4).ok());
    CHECK(world.pose(ball.body).rotation.y() == Approx(-angle).epsilon(0.01));
    CHECK(world.pose(ball.body).position.z() == Approx(radius).margin(1e-6));
}

TEST_CASE("worlds with rigid surfaces and given masses continue with the same bits", "[scene][rigid]") {
    const auto simulate = [](int threads) {
        Settings settings;
        settings.threads = threads;
        OneBody scene(settings, brick, {.position = {0, 0, 0.2}, .rotation = {0.2, 0.3, 0}});
        BodySettings body_settings = link_settings();
        body_settings.material = scene.material;
        body_settings.dynamics = BodyDynamics::rigid;
        body_settings.position = {0.05, 0, 0.6};
        const BodyHandle link = scene.world.add_body(brick, body_settings);
        const SpringHandle spring = Springs(scene.world)
                                        .add({.first = {.body = link, .point = {0.3, 0, 0.8}},
                                              .second = {.point = {0.5, 0, 1}},
                                              .stiffness = 30});
        CHECK((Springs(scene.world).state(spring).first.point - Vec3(0.3, 0, 0.8)).norm() < 1e-14);
        scene.world.add_body(mesh::ball(0.1, 3), {.material = scene.material, .position = {0, 0.05, 0.95}});
        scene.world.add_collider(Plane{});
        REQUIRE(scene.world.advance(0.3).ok());
        return scene;
    };
    check_same_bits(simulate, [](World& world) {
        world.set_material(world.materials()[0], {.density = 1500});
        REQUIRE(world.advance(0.2).ok());
    });
}

TEST_CASE("surfaces and mass properties that no rigid body can have are refused by name", "[scene][rigid]") {
    World world{Settings{}};
    const MaterialHandle material = world.add_material({});
    const auto add = [&](const SurfaceMesh& surface, BodySettings settings = {.dynamics = BodyDynamics::rigid}) {
        settings.material = material;
        settings.name = "arm";
        world.add_body(surface, settings);
    };
    const auto add_mass = [&](std::optional<Real> mass, std::optional<Vec3> center, std::optional<Mat3> inertia) {
        add(brick, {.dynamics = BodyDynamics::rigid, .mass = mass, .center_of_mass = center, .inertia = inertia});
    };
    for (const BodyDynamics deforms :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::automatic})
        CHECK_THROWS_WITH(add(brick, {.dynamics = deforms}),
                          Contains("body 'arm'") && Contains("needs a mesh of tetrahedra"));
    SurfaceMesh open = brick;
    open.triangles.pop_back();
    CHECK_THROWS_WITH(add(open), Contains("body 'arm'") && Contains("1 hole, the longest ") &&
                                     Contains(" m around at (") && Contains("a closed surface"));
    CHECK_THROWS_WITH(add(turned_inside_out(brick)),
                      Contains("1 shell that is inside out") && Contains("counter-clockwise"));
    CHECK_THROWS_WITH(add(both(brick, turned_inside_out(moved(brick, {1, 0, 0})))),
                      Contains("inside out at (1") && Contains("triangle 12"));

    CHECK_THROWS_WITH(add(both(brick, moved(brick, {0.03, 0.07, 0.05}))),
                      Contains("of two shells that cross") && Contains("give mass"));
    CHECK_NOTHROW(add(both(brick, moved(brick, {0.1, 0, 0}))));  // two shells that share a face

    const Mat3 unit = Mat3::Identity();
    CHECK_THROWS_WITH(add_mass({}, {}, unit), Contains("inertia") && Contains("center_of_mass"));
    CHECK_THROWS_WITH(add_mass({}, Vec3::Zero(), unit), Contains("a value without mass"));
    CHECK_THROWS_WITH(add_mass(1, Vec3::Zero(), {}), Contains("both center_of_mass and inertia"));
    CHECK_THROWS_WITH(add_mass(-1, {}, {}), Contains("a mass > 0 (kg)"));
    Mat3 skew = unit;
    skew(0, 1) = 0.1;
    CHECK_THROWS_WITH(add_mass(1, Vec3::Zero(), skew), Contains("a symmetric matrix"));
    for (const Vec3& moments : {Vec3(1, 1, 2.1), Vec3(1, 1, 0), Vec3(-1, 2, 2)})
        CHECK_THROWS_WITH(add_mass(1, Vec3::Zero(), Mat3(moments.asDiagonal())),
                          Contains("inertia") && Contains("none larger than the sum of the other two"));
    CHECK_NOTHROW(add_mass(1, Vec3::Zero(), Mat3(Vec3(1, 1, 2).asDiagonal())));  // a flat disc
    CHECK_THROWS_WITH(world.add_body(mesh::box(brick_size, {1, 1, 1}), {.material = material, .mass = 1}),
                      Contains("mass") && Contains("the dynamics rigid"));

    OneBody surface(Settings{}, brick), given(Settings{}, mesh::box(brick_size, {1, 1, 1}), {.mass = 2});
    CHECK_THROWS_WITH(surface.world.set_dynamics(surface.body, BodyDynamics::explicit_elastic),
                      Contains("without tetrahedra"));
    CHECK_THROWS_WITH(given.world.set_dynamics(given.body, BodyDynamics::implicit_elastic),
                      Contains("mass of the body is given"));
}

TEST_CASE("overlaps of surfaces at the start are resolved as those of tetrahedra, and refused inside each other",
          "[scene][rigid]") {
    const Vec3 by{0.05, 0.03, 0.04};
    const auto gap = [&](const auto& shape) {
        OneBody scene(weightless(), shape);
        const BodyHandle other =
            scene.world.add_body(shape, {.material = scene.material, .position = by, .dynamics = BodyDynamics::rigid});
        REQUIRE(scene.world.advance(0.1).ok());
        return Vec3(scene.world.center_of_mass(other) - scene.world.center_of_mass(scene.body));
    };
    CHECK(gap(brick).x() > brick_size.x());
    CHECK((gap(brick) - gap(mesh::box(brick_size, {1, 1, 1}))).norm() < 1e-9);
    const SurfaceMesh small = mesh::boundary(mesh::box(brick_size / 10, {1, 1, 1}));
    for (const auto& [first, second] : {std::pair(brick, small), std::pair(small, brick)}) {
        OneBody scene(weightless(), first, {.name = "first"});
        scene.world.add_body(second, {.material = scene.material, .dynamics = BodyDynamics::rigid, .name = "second"});
        CHECK_THROWS_WITH(scene.world.advance(0.1), Contains("is inside body '"));
    }
}

TEST_CASE("a scene makes a rigid body of an STL file", "[scene][rigid]") {
    std::ostringstream stl;
    stl << "solid peg\n";
    for (const std::array<Index, 3>& triangle : brick.triangles) {
        stl << "facet normal 0 0 0\nouter loop\n";
        for (const Index node : triangle) {
            const Vec3& x = brick.nodes[static_cast<std::size_t>(node)];
            stl << "vertex " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
        }
        stl << "endloop\nendfacet\n";
    }
    stl << "endsolid peg\n";
    const TemporaryFolder folder;
    folder.write("peg.stl", stl.str());
    const auto scene_of = [&](const std::string& keys) {
        return load_scene_text(R"({"materials": {"steel": {"density": 7800}}, "bodies": [{"name": "peg", "mesh": )"
                               R"({"file": "peg.stl"}, "material": "steel", "position": [0, 0, 0.2])" +
                                   keys +
                                   R"(}], "colliders": [{"shape": {"plane": {}}}], "probes": [{"name": "tip", )"
                                   R"("quantity": "motion", "body": "peg", "point": [0, 0, 0.5]}]})",
                               folder.path());
    };
    Scene scene = scene_of(R"(, "dynamics": "rigid", "sets": {"top": {"surface": true, "box": )"
                           R"({"lower": [-1, -1, 0.1], "upper": [1, 1, 1]}}})");
    const BodyHandle peg = scene.world.bodies()[0];
    CHECK(scene.world.mass(peg) == Approx(7800 * brick_size.prod()).epsilon(1e-12));
    REQUIRE(scene.world.advance(1).ok());
    CHECK(scene.world.center_of_mass(peg).z() == Approx(0.15).margin(0.005));

    Scene given = scene_of(R"(, "dynamics": "rigid", "mass": 3, "center_of_mass": [0, 0, 0.1], )"
                           R"("inertia": [[0.03, 0, 0], [0, 0.02, 0.001], [0, 0.001, 0.02]])");
    CHECK((given.world.center_of_mass(given.world.bodies()[0]) - Vec3(0, 0, 0.3)).norm() < 1e-14);
    CHECK_THROWS_WITH(scene_of(""), Contains("peg.stl") && Contains("a body that deforms needs tetrahedra"));
    CHECK_THROWS_WITH(scene_of(R"(, "dynamics": "rigid", "inertia": [[1, 0, 0], [0, 1, 0]])"), Contains("inertia"));
}

}  // namespace skerry::test::rigid_surfaces_test
