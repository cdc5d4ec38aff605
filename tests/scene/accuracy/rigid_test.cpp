// Rigid bodies against closed forms (docs/accuracy.md, items 41 to 46).
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::accuracy_rigid_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity;

BodySettings rigid(MaterialHandle material, const Vec3& position, const Vec3& rotation = Vec3::Zero(),
                   const Vec3& velocity = Vec3::Zero(), const Vec3& angular_velocity = Vec3::Zero()) {
    return {.material = material,
            .position = position,
            .rotation = rotation,
            .velocity = velocity,
            .angular_velocity = angular_velocity,
            .contact_distance = 0,
            .dynamics = BodyDynamics::rigid};
}

/// Rotation of a body about y [rad]
Real tilt(const World& world, BodyHandle body) {
    return world.pose(body).rotation.y();
}

/// A block that stands on one of its edges and is turned by `angle` about it.
struct RockingBlock {
    World world;
    Real half_width, half_height, diagonal, alpha;
    BodyHandle body;

    RockingBlock(Real width, Real height, Real angle, Real h)
        : world([h] {
              Settings settings = accurate({0, 0, -g}, 1e-10);
              settings.step_size = h;
              return settings;
          }()),
          half_width(width / 2),
          half_height(height / 2),
          diagonal(std::hypot(half_width, half_height)),
          alpha(std::atan(half_width / half_height)) {
        const auto material = world.add_material({.friction = 2});
        world.add_collider(Plane{});
        // The edge at x = half_width, z = 0 does not move.
        const Vec3 center(half_width - diagonal * std::sin(alpha - angle), 0, diagonal * std::cos(alpha - angle));
        body = world.add_body(mesh::box({width, 0.1, height}, {1, 1, 1}), rigid(material, center, {0, angle, 0}));
    }
    /// Angular velocity about y [rad/s]
    Real spin() const {
        const auto position = world.positions(body);
        const auto velocity = world.velocities(body);
        const Vec3 edge = position[7] - position[0], rate = velocity[7] - velocity[0];
        return edge.cross(rate).y() / (edge.x() * edge.x() + edge.z() * edge.z());
    }
};

}  // namespace

TEST_CASE("a rigid top keeps its angular momentum", "[scene][accuracy]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = 1.0 / 60;
    World world(settings);
    const auto material = world.add_material({});
    world.add_body(mesh::box({0.1, 0.2, 0.3}, {1, 2, 3}),
                   rigid(material, Vec3::Zero(), {0.1, 0.2, 0.3}, Vec3::Zero(), {0.3, 5, 0.2}));
    const WorldReport start = world.report();
    Real turned = 0, energy = 0;
    for (int frame = 0; frame < 600; ++frame) {
        REQUIRE(world.advance(1.0 / 60).ok());
        const WorldReport now = world.report();
        turned =
            std::max(turned, (now.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm());
        energy = std::max(energy, std::abs(now.energy.kinetic / start.energy.kinetic - 1));
    }
    accuracy::check({.item = 41,
                     .name = "free rigid top, 600 steps of 1/60 s, worst change of angular momentum over its size",
                     .formula = "L constant",
                     .found = turned,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 41,
                     .name = "free rigid top, 600 steps of 1/60 s, worst change of energy over itself",
                     .formula = "E constant, bounded error of order 2",
                     .found = energy,
                     .tolerance = 1e-3,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a rigid block on an incline obeys Coulomb's law at any step", "[scene][accuracy]") {
    constexpr Real mu = 0.3;
    const Real critical = std::atan(mu) * 180 / std::numbers::pi;
    for (const Real h : {1.0 / 60, 1.0 / 1000}) {
        const auto on_slope = [&](Real degrees, Real& before, Real& after, Real& moved) {
            Settings settings = accurate(tilted_gravity(degrees), 1e-10);
            settings.step_size = h;
            World world(settings);
            const auto material = world.add_material({.friction = mu});
            world.add_collider(Plane{});
            const auto body = world.add_body(mesh::box({0.1, 0.1, 0.05}, {2, 2, 1}), rigid(material, {0, 0, 0.025}));
            REQUIRE(world.advance(1).ok());
            before = world.velocities(body)[0].x();
            const Vec3 start = world.center_of_mass(body);
            REQUIRE(world.advance(1).ok());
            after = world.velocities(body)[0].x();
            moved = (world.center_of_mass(body) - start).norm();
        };
        const std::string step = h < 0.01 ? ", h = 1/1000 s" : ", h = 1/60 s";
        Real before, after, moved;
        on_slope(critical - 0.1, before, after, moved);
        accuracy::check({.item = 42,
                         .name = "rigid block 0.1 degree below critical, slip in 1 s (m)" + step,
                         .formula = "0 while tan(a) <= mu",
                         .found = moved,
                         .tolerance = 1e-9,
                         .kind = Tolerance::absolute});
        on_slope(critical + 0.1, before, after, moved);
        const Real a = (critical + 0.1) * std::numbers::pi / 180;
        accuracy::check({.item = 42,
                         .name = "rigid block 0.1 degree above critical, acceleration (m/s^2)" + step,
                         .formula = "g (sin(a) - mu cos(a))",
                         .expected = g * (std::sin(a) - mu * std::cos(a)),
                         .found = after - before,
                         .tolerance = 1e-3});
    }
}

TEST_CASE("a slender rigid block rocks with Housner's period", "[scene][accuracy]") {
    RockingBlock block(0.05, 0.5, 0, 1e-4);
    const Real start = 0.5 * block.alpha;
    block = RockingBlock(0.05, 0.5, start, 1e-4);
    Real time = 0;
    while (tilt(block.world, block.body) > 0 && time < 2) {
        REQUIRE(block.world.advance(1e-4).ok());
        time += 1e-4;
    }
    const Real p = std::sqrt(3 * g / (4 * block.diagonal));
    accuracy::check({.item = 43,
                     .name = "slender rigid block let go at half its critical angle, time until it is upright (s)",
                     .formula = "acosh(1/(1 - theta_0/alpha))/p, p^2 = 3 g/(4 R)",
                     .expected = std::acosh(1 / (1 - start / block.alpha)) / p,
                     .found = time,
                     .tolerance = 0.01});
}

TEST_CASE("a rigid block that rocks onto its other edge loses energy by Housner's formula", "[scene][accuracy]") {
    RockingBlock block(0.1, 0.2, 0.15, 1e-4);
    Real before = 0, time = 0;
    while (tilt(block.world, block.body) > 1e-4 && time < 2) {
        before = block.spin();
        REQUIRE(block.world.advance(1e-4).ok());
        time += 1e-4;
    }
    REQUIRE(block.world.advance(4e-4).ok());
    const Real sine = std::sin(block.alpha);
    accuracy::check({.item = 43,
                     .name = "rigid block 0.1 m x 0.2 m, spin after over spin before it changes its edge",
                     .formula = "1 - 3/2 sin(alpha)^2",
                     .expected = 1 - 1.5 * sine * sine,
                     .found = block.spin() / before,
                     .tolerance = 0.02});
}

TEST_CASE("rigid bricks overhang as far as the harmonic series lets them", "[scene][accuracy]") {
    constexpr Real length = 0.2, height = 0.05;
    constexpr int bricks = 4;
    for (const Real share : {0.99, 1.01}) {
        Settings settings = accurate({0, 0, -g}, 1e-8);
        settings.step_size = 1e-3;
        World world(settings);
        const auto material = world.add_material({.friction = 0.7});
        world.add_collider(Plane{});
        std::vector<BodyHandle> stack;
        Real x = 0;
        for (int k = 0; k < bricks; ++k) {
            // The lowest brick is shifted least: by L/(2 n). The ones above are shifted by L/(2 (n - 1)), ... L/4, L/2.
            stack.push_back(world.add_body(mesh::box({length, 0.1, height}, {4, 2, 1}),
                                           rigid(material, {x, 0, (k + 0.5) * height})));
            x += share * length / (2 * (bricks - 1 - k));
        }
        REQUIRE(world.advance(3).ok());
        Real lowest = 1;
        for (int k = 0; k < bricks; ++k)
            lowest =
                std::min(lowest, world.center_of_mass(stack[static_cast<std::size_t>(k)]).z() / ((k + 0.5) * height));
        const std::string outcome_text = share < 1 ? "0.99" : "1.01";
        accuracy::check({.item = 44,
                         .name = "four rigid bricks, each shifted by " + outcome_text + " L/(2 k), one fell within 3 s",
                         .formula = "stands up to L/(2 k)",
                         .expected = share < 1 ? 0.0 : 1.0,
                         .found = lowest < 0.9 ? 1.0 : 0.0,
                         .tolerance = 0,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("a heavy rigid block on a light one presses on the floor with both weights", "[scene][accuracy]") {
    Settings settings = accurate({0, 0, -g}, 1e-8);
    settings.step_size = 1.0 / 120;
    World world(settings);
    const auto light = world.add_material({.density = 10}), heavy = world.add_material({.density = 1e5});
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    world.add_body(cube, rigid(light, {0, 0, 0.05}));
    world.add_body(cube, rigid(heavy, {0, 0, 0.15}));
    world.add_collider(Plane{});
    const StepReport report = world.advance(1);
    REQUIRE(report.ok());
    Real floor = 0;
    for (const Contact& contact : world.contacts())
        if (contact.second == BodyHandle{}) floor += contact.impulse.z();
    accuracy::check({.item = 45,
                     .name = "rigid cubes of 100 kg on 0.01 kg, force of the floor (N), h = 1/120 s",
                     .formula = "(M + m) g",
                     .expected = (100 + 0.01) * g,
                     .found = floor * 120,
                     .tolerance = 1e-3});
    accuracy::check({.item = 45,
                     .name = "the same, largest overlap of 120 steps (m)",
                     .formula = "0",
                     .found = report.max_penetration,
                     .tolerance = 1e-8,
                     .kind = Tolerance::absolute});
}

TEST_CASE("three rigid cubes in a row that touch go on together", "[scene][accuracy]") {
    Settings settings = accurate(Vec3::Zero(), 1e-12);
    settings.step_size = 1e-3;
    World world(settings);
    const auto material = world.add_material({.friction = 0});
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    std::vector<BodyHandle> row;
    for (int k = 0; k < 3; ++k)
        row.push_back(world.add_body(
            cube, rigid(material, {0.1 * k - (k == 0 ? 0.01 : 0.0), 0, 0}, Vec3::Zero(), {k == 0 ? 1.0 : 0.0, 0, 0})));
    REQUIRE(world.advance(0.05).ok());
    for (const BodyHandle body : row)
        accuracy::check({.item = 46,
                         .name = "row of three equal rigid cubes, hit by the first at 1 m/s, speed of '" +
                                 world.name(body) + "' (m/s)",
                         .formula = "v_0/3 (restitution 0)",
                         .expected = 1.0 / 3,
                         .found = world.velocities(body)[0].x(),
                         .tolerance = 1e-9});
}

}  // namespace skerry::test::accuracy_rigid_test
