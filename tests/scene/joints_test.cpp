// Joints of rigid bodies in whole steps, against closed forms (docs/methods/joints.md).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "skerry/joint.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::joints_test {

namespace {

constexpr Real length = 0.4, side = 0.04, reach = 0.25;  // of a bar; `reach`: from its centre to the joint [m]
const Mesh bar = mesh::box({side, side, length}, {1, 1, 2});
const Real bar_mass = 1000 * side * side * length;                         // density of water [kg]
const Real bar_inertia = bar_mass * (length * length + side * side) / 12;  // about x or y [kg m^2]
const Real swing_inertia = bar_inertia + bar_mass * reach * reach;         // about the joint [kg m^2]

Settings with_step(Real h, const Vec3& gravity = {0, 0, -standard_gravity}) {
    Settings settings = accurate(gravity, 1e-10);
    settings.step_size = h;
    return settings;
}

/// A chain of bars, the first attached to the world at the origin. All start at one angle from their rest positions.
struct Bars {
    World world;
    MaterialHandle material;
    std::vector<BodyHandle> body;
    std::vector<JointHandle> joint;

    Bars(const Settings& settings, int count, Real angle, JointKind kind, Index threads = 1)
        : world([&] {
              Settings with = settings;
              with.threads = threads;
              return with;
          }()),
          material(world.add_material({})) {
        const Vec3 along(std::sin(angle), 0, -std::cos(angle));
        Vec3 point = Vec3::Zero();
        for (int k = 0; k < count; ++k) {
            body.push_back(world.add_body(bar, {.material = material,
                                                .position = point + reach * along,
                                                .rotation = {0, -angle, 0},
                                                .dynamics = BodyDynamics::rigid}));
            JointSettings settings_of{.kind = kind, .first = body.back(), .point = point, .axis = {0, -1, 0}};
            if (k > 0) settings_of.second = body[static_cast<std::size_t>(k) - 1];
            joint.push_back(Joints(world).add(settings_of));
            point += 2 * reach * along;
        }
    }
};

/// Period: time from the first to the third passage of the lowest point [s]
Real period_of(Bars& bars, Real h) {
    std::vector<Real> passages;
    Real before = bars.world.center_of_mass(bars.body[0]).x();
    while (passages.size() < 3 && bars.world.time() < 20) {
        REQUIRE(bars.world.advance(h).ok());
        const Real now = bars.world.center_of_mass(bars.body[0]).x();
        if ((before > 0) != (now > 0)) passages.push_back(bars.world.time() - h * now / (now - before));
        before = now;
    }
    REQUIRE(passages.size() == 3);
    return passages[2] - passages[0];
}

}  // namespace

TEST_CASE("a pendulum swings with the period of small and of large amplitudes", "[scene][joints]") {
    const Real rate = std::sqrt(bar_mass * standard_gravity * reach / swing_inertia);
    for (const JointKind kind : {JointKind::ball, JointKind::hinge})
        for (const Real angle : {0.02, 1.0, 2.5}) {
            const Real h = 1.0 / 500;
            Bars bars(with_step(h), 1, angle, kind);
            const Real expected = 4 / rate * std::comp_ellint_1(std::sin(angle / 2));
            CHECK(period_of(bars, h) == Approx(expected).epsilon(2e-4));
            CHECK(Joints(bars.world).state(bars.joint[0]).error < 1e-6);
            CHECK(bars.world.report().momentum_error_share < 1e-10);
        }
}

TEST_CASE("the period of a pendulum converges with the step", "[scene][joints]") {
    const Real rate = std::sqrt(bar_mass * standard_gravity * reach / swing_inertia);
    const Real expected = 4 / rate * std::comp_ellint_1(std::sin(0.75));
    std::vector<Real> error;
    for (const Real h : {1.0 / 120, 1.0 / 240}) {  // the body rotates by less than 0.1 rad in a step
        Bars bars(with_step(h), 1, 1.5, JointKind::hinge);
        error.push_back(std::abs(period_of(bars, h) / expected - 1));
    }
    CHECK(error[0] < 5e-3);
    CHECK(error[1] < 0.6 * error[0]);
}

TEST_CASE("a double pendulum keeps its energy", "[scene][joints]") {
    for (const Real h : {1.0 / 120, 1.0 / 480}) {
        Bars bars(with_step(h), 2, 2.0, JointKind::hinge);
        const Energy start = bars.world.energy();
        const Real scale = 4 * bar_mass * standard_gravity * reach;  // energy to turn the second bar upright [J]
        Real most = 0;
        for (int k = 0; k < 200; ++k) {
            REQUIRE(bars.world.advance(0.05).ok());
            const Energy now = bars.world.energy();
            most = std::max(most, std::abs(now.kinetic + now.potential - start.kinetic - start.potential));
        }
        CAPTURE(h);
        CHECK(most < 0.06 * scale * h * 120);
        CHECK(bars.world.report().energy_error_share < 1e-3);
    }
}

TEST_CASE("a chain of ten hangs at rest, and each joint carries the weight below it", "[scene][joints]") {
    for (const JointKind kind : {JointKind::ball, JointKind::hinge, JointKind::fixed}) {
        Bars bars(with_step(1.0 / 120), 10, 0, kind);
        REQUIRE(bars.world.advance(1).ok());
        for (std::size_t k = 0; k < 10; ++k) {
            const JointState joint = Joints(bars.world).state(bars.joint[k]);
            const Real below = static_cast<Real>(10 - k) * bar_mass * standard_gravity;
            CHECK(joint.force.z() == Approx(below).epsilon(1e-6));
            CHECK(joint.force.head<2>().norm() < 1e-6 * below);
            CHECK(joint.moment.norm() < 1e-6 * below * length);
            CHECK(joint.error < 1e-9);
        }
        const Vec3 last = bars.world.center_of_mass(bars.body.back());
        CHECK((last - Vec3(0, 0, -19 * reach)).norm() < 1e-8);
    }
}

TEST_CASE("the forces of joints on swinging bars add up to the changes of their momenta", "[scene][joints]") {
    constexpr Real h = 1.0 / 480;
    for (const JointKind kind : {JointKind::ball, JointKind::hinge, JointKind::fixed}) {
        Bars bars(with_step(h), 2, 2.0, kind);
        bars.world.set_velocity(bars.body[1], Vec3::Zero(), {0, 8, 0});
        const auto momentum = [&](std::size_t b) -> Vec3 {
            return bar_mass * bars.world.velocity(bars.body[b]).velocity;
        };
        const auto force = [&](std::size_t j) { return Joints(bars.world).state(bars.joint[j]).force; };
        const Vec3 weight(0, 0, -bar_mass * standard_gravity);
        Real worst = 0;
        for (int k = 0; k < 200; ++k) {
            const Vec3 first = momentum(0), second = momentum(1);
            REQUIRE(bars.world.advance(h).steps == 1);
            worst = std::max({worst, (momentum(0) - first - h * (force(0) - force(1) + weight)).norm(),
                              (momentum(1) - second - h * (force(1) + weight)).norm()});
        }
        CAPTURE(static_cast<int>(kind));
        CHECK(worst < 1e-12 * h * weight.norm());
    }
}

TEST_CASE("joined bodies keep their common momenta", "[scene][joints]") {
    for (const JointKind kind : {JointKind::ball, JointKind::hinge, JointKind::slider, JointKind::fixed}) {
        World world(with_step(1.0 / 240, Vec3::Zero()));
        const auto material = world.add_material({});
        const auto first = world.add_body(bar, {.material = material,
                                                .velocity = {0.1, 0.3, 0},
                                                .angular_velocity = {1, 2, -1},
                                                .dynamics = BodyDynamics::rigid});
        const auto second = world.add_body(bar, {.material = material,
                                                 .position = {0.3, 0, 0.1},
                                                 .rotation = {0, 1.2, 0},
                                                 .velocity = {-0.2, 0, 0.3},
                                                 .dynamics = BodyDynamics::rigid});
        const auto joint = Joints(world).add(
            {.kind = kind, .first = first, .second = second, .point = {0.1, 0, 0.15}, .axis = {1, 2, 3}});
        REQUIRE(world.advance(0.1).ok());
        const WorldReport before = world.report();
        REQUIRE(world.advance(1).ok());
        const WorldReport after = world.report();
        CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
        CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-12 * before.angular_momentum.norm());
        CHECK(Joints(world).state(joint).error < 1e-5);
        CHECK(after.energy.kinetic == Approx(before.energy.kinetic).epsilon(2e-2));
        if (kind == JointKind::hinge || kind == JointKind::slider)
            CHECK(std::abs(Joints(world).state(joint).coordinate) > 0.01);
    }
}

TEST_CASE("two bodies that a fixed joint joins move as one", "[scene][joints]") {
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), both = mesh::box({0.2, 0.1, 0.1}, {2, 1, 1});
    World world(with_step(1.0 / 500, Vec3::Zero())), one(with_step(1.0 / 500, Vec3::Zero()));
    const Vec3 turning(0.5, 3, 1);
    const auto of_one = one.add_material({}), material = world.add_material({});
    const auto whole =
        one.add_body(both, {.material = of_one, .angular_velocity = turning, .dynamics = BodyDynamics::rigid});
    const auto add = [&](Real x) {
        return world.add_body(cube, {.material = material,
                                     .position = {x, 0, 0},
                                     .velocity = turning.cross(Vec3(x, 0, 0)),
                                     .angular_velocity = turning,
                                     .dynamics = BodyDynamics::rigid});
    };
    const auto left = add(-0.05), right = add(0.05);
    Joints(world).add({.kind = JointKind::fixed, .first = left, .second = right});
    REQUIRE(world.advance(1).ok());
    REQUIRE(one.advance(1).ok());
    CHECK((world.center_of_mass(left) + world.center_of_mass(right)).norm() < 1e-12);
    CHECK((world.pose(left).rotation - one.pose(whole).rotation).norm() < 2e-3);
    CHECK((world.pose(left).rotation - world.pose(right).rotation).norm() < 1e-6);
    CHECK(world.report().energy.kinetic == Approx(one.report().energy.kinetic).epsilon(1e-4));
}

TEST_CASE("a slider lets a body fall along its axis alone, on a slope against friction", "[scene][joints]") {
    const Real degrees = 30, mu = 0.2;
    for (const bool with_plane : {false, true}) {
        Settings settings = accurate(tilted_gravity(degrees), 1e-10);
        settings.step_size = 1.0 / 250;
        World world(settings);
        const auto material = world.add_material({.friction = mu});
        const Mesh block = mesh::box({0.1, 0.1, 0.05}, {2, 2, 1});
        const auto body = world.add_body(
            block,
            {.material = material, .position = {0, 0, 0.025}, .contact_distance = 0, .dynamics = BodyDynamics::rigid});
        if (with_plane) world.add_collider(Plane{});
        // With the plane beneath, the slider prevents rotation and sideways motion.
        const auto slider = Joints(world).add(
            {.kind = JointKind::slider, .first = body, .point = {0, 0, 0.025}, .axis = {1, 0, 0}, .upper = 0.5});
        if (with_plane) world.set_gravity(tilted_gravity(degrees) + Vec3(0, 1, 0));
        REQUIRE(world.advance(0.2).ok());
        const JointState before = Joints(world).state(slider);
        REQUIRE(world.advance(0.1).ok());
        const JointState now = Joints(world).state(slider);
        const Real down = standard_gravity * std::sin(degrees * std::numbers::pi / 180);
        if (!with_plane) CHECK((now.speed - before.speed) / 0.1 == Approx(down).epsilon(1e-9));
        // The division of the weight between slider and plane is not unique: the slider may carry all of it.
        CHECK((now.speed - before.speed) / 0.1 < down * (1 + 1e-9));
        CHECK(std::abs(world.center_of_mass(body).y()) < 1e-9);
        CHECK(world.center_of_mass(body).z() == Approx(0.025).margin(1e-6));
        CHECK(now.coordinate == Approx(world.center_of_mass(body).x()).margin(1e-12));
        REQUIRE(world.advance(1).ok());
        CHECK(Joints(world).state(slider).coordinate == Approx(0.5).margin(1e-6));
        CHECK(Joints(world).state(slider).speed == Approx(0).margin(1e-6));
    }
}

TEST_CASE("a world with joints goes on bit by bit when it is cloned or saved, on any number of workers",
          "[scene][joints]") {
    const auto make = [](int threads) {
        Bars bars({}, 4, 0.7, JointKind::ball, threads);
        bars.world.add_collider(Plane{.point = {0, 0, -1.6}});
        Joints(bars.world)
            .add({.kind = JointKind::hinge,
                  .first = bars.world.add_body(
                      bar, {.material = bars.material, .position = {2, 0, 0}, .dynamics = BodyDynamics::rigid}),
                  .point = {2, 0, 0},
                  .axis = {0, 1, 0},
                  .upper = 5.0,
                  .motor = JointMotor{.strength = 0.1, .keys = {{.time = 0, .speed = 2}, {.time = 1.2, .speed = -1}}}});
        return bars;
    };
    Bars one = make(1);
    REQUIRE(one.world.advance(1).ok());
    CHECK(one.world.report().mean_contacts > 0);
    for (const int threads : {2, 3, 4}) {
        Bars other = make(threads);
        REQUIRE(other.world.advance(1).ok());
        CHECK(one.world.state_hash() == other.world.state_hash());
    }
    World copy = one.world.clone();
    const TemporaryFolder folder;
    one.world.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world");
    CHECK(loaded.state_hash() == one.world.state_hash());
    for (World* world : {&one.world, &copy, &loaded}) {
        REQUIRE(world->advance(0.3).ok());
        Joints(*world).remove(one.joint[2]);
        REQUIRE(world->advance(0.3).ok());
    }
    CHECK(copy.state_hash() == one.world.state_hash());
    CHECK(loaded.state_hash() == one.world.state_hash());
    CHECK(Joints(copy).alive(one.joint[1]));
    CHECK_FALSE(Joints(copy).alive(one.joint[2]));
}

TEST_CASE("a chain that falls onto the floor stays joined, and its momentum adds up", "[scene][joints]") {
    Bars bars({}, 5, 1.2, JointKind::ball);
    bars.world.add_collider(Plane{.point = {0, 0, -1.3}});
    Joints(bars.world).remove(bars.joint[0]);
    Real apart = 0;
    for (int k = 0; k < 40; ++k) {
        REQUIRE(bars.world.advance(0.05).ok());
        for (std::size_t j = 1; j < bars.joint.size(); ++j)
            apart = std::max(apart, Joints(bars.world).state(bars.joint[j]).error);
    }
    const WorldReport report = bars.world.report();
    CHECK(apart < 0.1 * side);
    CHECK(report.mean_contacts > 1);
    CHECK(report.momentum_error_share < 1e-12);
    CHECK(report.energy_error_share < 5e-3);
    CHECK(report.max_penetration < 0.1 * side);
}

TEST_CASE("joined bodies rest together, and wake together", "[scene][joints]") {
    Settings settings;
    settings.sleep = true;
    Bars bars(settings, 3, 0, JointKind::ball);
    REQUIRE(bars.world.advance(2).ok());
    for (const BodyHandle body : bars.body) CHECK(bars.world.asleep(body));
    const Real force = Joints(bars.world).state(bars.joint[0]).force.z();
    CHECK(force == Approx(3 * bar_mass * standard_gravity).epsilon(5e-3));
    bars.world.set_velocity(bars.body[2], {0.5, 0, 0});
    REQUIRE(bars.world.advance(0.3).ok());
    for (const BodyHandle body : bars.body) CHECK_FALSE(bars.world.asleep(body));
    CHECK(bars.world.center_of_mass(bars.body[0]).x() != 0);
    CHECK(Joints(bars.world).state(bars.joint[2]).error < 1e-4);
}

TEST_CASE("joints go with their bodies, and rows of others follow", "[scene][joints]") {
    Bars bars({}, 4, 0, JointKind::ball);
    CHECK(Joints(bars.world).all() == bars.joint);
    CHECK_FALSE(bars.world.may_collide(bars.body[1], bars.body[2]));
    Joints(bars.world).remove(bars.joint[2]);
    CHECK(bars.world.may_collide(bars.body[1], bars.body[2]));
    bars.world.remove(bars.body[1]);
    CHECK_FALSE(Joints(bars.world).alive(bars.joint[1]));
    CHECK(Joints(bars.world).all() == std::vector{bars.joint[0], bars.joint[3]});
    REQUIRE(bars.world.advance(0.2).ok());
    CHECK(bars.world.center_of_mass(bars.body[0]).z() == Approx(-reach).epsilon(1e-9));
    CHECK(Joints(bars.world).state(bars.joint[3]).error < 1e-9);
    CHECK(Joints(bars.world).state(bars.joint[3]).force.norm() < 1e-9);  // both fall freely
    CHECK(Joints(bars.world).state(bars.joint[3]).first == bars.body[3]);
    CHECK(Joints(bars.world).state(bars.joint[3]).second == bars.body[2]);
}

/// Sum of kinetic and potential energy [J]
Real mechanical_energy(const World& world) {
    return world.energy().kinetic + world.energy().potential;
}

TEST_CASE("a fast top on a ball joint precesses at its tilt", "[scene][joints]") {
    constexpr Real tilt = 0.35, arm = 0.06, radius = 0.05, spin = 200;  // [rad], [m], [m], [rad/s]
    World world{Settings{}};
    const Vec3 axis(std::sin(tilt), 0, std::cos(tilt));
    const auto top = world.add_body(Cylinder{.radius = radius, .height = 0.02}, {.material = world.add_material({}),
                                                                                 .position = arm * axis,
                                                                                 .rotation = {0, tilt, 0},
                                                                                 .angular_velocity = spin * axis});
    const JointHandle joint = Joints(world).add({.kind = JointKind::ball, .first = top});
    const Real energy = mechanical_energy(world);
    Real angle = 0;
    for (int frame = 0; frame < 60; ++frame) {
        const Vec3 before = world.center_of_mass(top);
        REQUIRE(world.advance(1.0 / 60).ok());
        const Vec3 after = world.center_of_mass(top);
        angle += std::atan2(before.cross(after).z(), before.head<2>().dot(after.head<2>()));
        CHECK(after.norm() == Approx(arm).epsilon(1e-3));
        CHECK(after.z() == Approx(arm * std::cos(tilt)).epsilon(0.02));  // the nutation from rest: 1 %
    }
    // A fast top precesses at m g arm / (I spin) with I = m radius^2 / 2. The next term of the series in 1 / spin is
    // 4 % of it, and the nutation from rest adds at most 2 %.
    CHECK(angle == Approx(2 * standard_gravity * arm / (radius * radius * spin)).epsilon(0.06));
    CHECK(mechanical_energy(world) == Approx(energy).epsilon(1e-3));
    CHECK(Joints(world).state(joint).error < 1e-4);
}

TEST_CASE("a whipping chain keeps its energy at the default step", "[scene][joints]") {
    constexpr Real link = 0.1;  // [m]
    World world{Settings{}};
    const auto material = world.add_material({});
    BodyHandle before;
    Real mass = 0;
    for (int k = 0; k < 10; ++k) {
        const auto body =
            world.add_body(Capsule{.radius = 0.01, .length = 0.08}, {.material = material,
                                                                     .position = {(k + 0.5) * link, 0, 0},
                                                                     .rotation = {0, std::numbers::pi / 2, 0},
                                                                     .collision_mask = 0});
        JointSettings joint{.kind = JointKind::ball, .first = body, .point = {k * link, 0, 0}};
        if (k > 0) joint.second = before;
        Joints(world).add(joint);
        before = body;
        mass += world.mass(body);
    }
    const Real energy = mechanical_energy(world);
    for (int frame = 0; frame < 180; ++frame) REQUIRE(world.advance(1.0 / 60).ok());
    const Real exchanged = mass * standard_gravity * 5 * link;  // the centre of mass falls by half the length
    CHECK(std::abs(mechanical_energy(world) - energy) < 0.02 * exchanged);
}

TEST_CASE("objects that joints cannot join are refused by name", "[scene][joints]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto soft = world.add_body(bar, {.material = material, .name = "noodle"});
    const auto first =
        world.add_body(bar, {.material = material, .position = {1, 0, 0}, .dynamics = BodyDynamics::rigid});
    const auto refused = [&](const JointSettings& joint, const char* message) {
        CHECK_THROWS_WITH(Joints(world).add(joint), Catch::Matchers::Contains(message));
    };
    refused({.first = soft}, "noodle");
    refused({.first = first, .second = soft}, "noodle");
    refused({.first = first, .second = first}, "found the first body of the joint");
    refused({.kind = JointKind::hinge, .first = first, .axis = {0, 0, 0}}, "axis");
    refused({.first = first, .point = {NAN, 0, 0}}, "point");
    refused({.kind = JointKind::hinge, .first = first, .lower = 1.0, .upper = 0.0}, "lower");
    refused({.kind = JointKind::hinge, .first = first, .motor = JointMotor{.strength = 1}}, "motor");
    refused({.kind = JointKind::hinge, .first = first, .motor = JointMotor{.speed = 1, .strength = -1}}, "strength");
    refused({.kind = JointKind::ball, .first = first, .upper = 1.0}, "ball");
    refused({.kind = JointKind::fixed, .first = first, .motor = JointMotor{.speed = 1}}, "fixed");
    CHECK(Joints(world).all().empty());
}

}  // namespace skerry::test::joints_test
