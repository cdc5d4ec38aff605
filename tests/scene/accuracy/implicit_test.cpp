// Implicit bodies against closed forms (docs/accuracy.md, items 47 to 49).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::implicit_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity;

/// Change of velocity and distance, in its second second, of a block of 0.5 kg on a tilted plane.
struct Slide {
    Real gained, moved;  // m/s, m
};
Slide slide_of(Real modulus, Real mu, Real degrees, Real h) {
    Settings settings = accurate(tilted_gravity(degrees), 1e-10);
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3, .friction = mu});
    world.add_collider(Plane{});
    const auto body =
        world.add_body(mesh::box({0.1, 0.1, 0.05}, {2, 2, 1}), {.material = material,
                                                                .position = {0, 0, 0.025},
                                                                .contact_distance = 0,
                                                                .dynamics = BodyDynamics::implicit_elastic});
    const Real mass = world.mass(body);
    REQUIRE(world.advance(1).ok());
    const Real before = world.report().momentum.x() / mass;
    const Vec3 start = world.center_of_mass(body);
    REQUIRE(world.advance(1).ok());
    return {world.report().momentum.x() / mass - before, (world.center_of_mass(body) - start).norm()};
}

/// Kinetic plus elastic energy [J]
Real mechanical(const World& world) {
    const Energy energy = world.report().energy;
    return energy.kinetic + energy.elastic;
}

}  // namespace

TEST_CASE("an implicit block on an incline obeys Coulomb's law at any stiffness and step", "[scene][accuracy]") {
    constexpr Real mu = 0.3;
    const Real critical = std::atan(mu) * 180 / std::numbers::pi, a = std::atan(mu) + 0.1 * std::numbers::pi / 180;
    struct Case {
        Real modulus;
        const char* name;
    };
    for (const Case& test_case : {Case{1e6, "1e6"}, Case{1e7, "1e7"}, Case{1e9, "1e9"}, Case{2e11, "2e11"}})
        for (const Real h : {1.0 / 60, 1.0 / 1000}) {
            const std::string with =
                std::string(", E = ") + test_case.name + (h < 0.01 ? ", h = 1/1000 s" : ", h = 1/60 s");
            accuracy::check({.item = 47,
                             .name = "implicit block 0.1 degree below critical, slip in 1 s (m)" + with,
                             .formula = "0 while tan(a) <= mu",
                             .found = slide_of(test_case.modulus, mu, critical - 0.1, h).moved,
                             .tolerance = 1e-9,
                             .kind = Tolerance::absolute});
            accuracy::check({.item = 47,
                             .name = "implicit block 0.1 degree above critical, acceleration (m/s^2)" + with,
                             .formula = "g (sin(a) - mu cos(a))",
                             .expected = g * (std::sin(a) - mu * std::cos(a)),
                             .found = slide_of(test_case.modulus, mu, critical + 0.1, h).gained,
                             .tolerance = 1e-3});
        }
}

TEST_CASE("a vibration of an implicit rod is damped as theta says", "[scene][accuracy]") {
    constexpr Real length = 1, modulus = 1e6, density = 1000;
    constexpr int steps = 50;  // per period
    const Real period = 2 * length * std::sqrt(density / modulus), z = 2 * std::numbers::pi / steps;
    const Mesh rod = mesh::box({length, 0.05, 0.05}, {20, 1, 1});
    std::vector<Vec3> stretched;
    for (const Vec3& x : rod.nodes)
        stretched.push_back(x + Vec3(1e-3 * std::sin(std::numbers::pi * x.x() / length), 0, 0));
    for (const Real theta : {1.0, 0.75, 0.55, 0.5}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.step_size = period / steps;
        settings.theta = theta;
        World world(settings);
        const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = 0, .density = density});
        const auto body = world.add_body(rod, {.material = material, .dynamics = BodyDynamics::implicit_elastic});
        world.set_positions(body, stretched);
        const Real start = mechanical(world);
        REQUIRE(world.advance(5 * period).ok());
        accuracy::check(
            {.item = 48,
             .name = "first mode of a free rod, energy kept in 5 periods of 50 steps, theta = " +
                     std::to_string(theta).substr(0, 4),
             .formula = "((1 + (1 - theta)^2 z^2) / (1 + theta^2 z^2))^250",
             .expected = std::pow((1 + (1 - theta) * (1 - theta) * z * z) / (1 + theta * theta * z * z), 5 * steps),
             .found = mechanical(world) / start,
             .tolerance = 0.05});
    }
}

TEST_CASE("no step of implicit bodies that hit each other gains energy", "[scene][accuracy]") {
    for (const Real theta : {1.0, 0.55}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.step_size = 1.0 / 240;
        settings.theta = theta;
        World world(settings);
        const auto material = world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3});
        const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
        for (int k = 0; k < 5; ++k)  // a row of cubes, the first thrown at the others
            world.add_body(cube, {.material = material,
                                  .position = {0.12 * k, 0.01 * k, 0.005 * k},
                                  .velocity = {k == 0 ? 3.0 : 0.0, 0, 0},
                                  .angular_velocity = {0.3, 0.2 * k, 0.5},
                                  .dynamics = BodyDynamics::implicit_elastic});
        const Real start = mechanical(world);
        Real before = start, gained = 0;
        for (int step = 0; step < 480; ++step) {
            REQUIRE(world.advance(1.0 / 240).ok());
            const Real now = mechanical(world);
            gained = std::max(gained, (now - before) / start);
            before = now;
        }
        CHECK(before < 0.8 * start);  // they have hit each other
        accuracy::check(
            {.item = 49,
             .name = "five implicit cubes that hit each other, worst gain of a step over the energy, theta = " +
                     std::to_string(theta).substr(0, 4),
             .formula = "E+ <= E",
             .found = gained,
             .tolerance = 1e-12,
             .kind = Tolerance::absolute});
        accuracy::check({.item = 49,
                         .name = "the same, kinetic, elastic and dissipated energy at the end over the start - 1",
                         .formula = "0",
                         .found = (before + world.report().energy.dissipated) / start - 1,
                         .tolerance = 1e-10,
                         .kind = Tolerance::absolute});
    }
}

}  // namespace skerry::test::implicit_test
