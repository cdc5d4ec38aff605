// Error estimates of a run: balances of energy and momentum, and inverted elements.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/world/tuning.h"
#include "skerry/cavity.h"
#include "tests/support/filled_sphere.h"
#include "tests/support/worlds.h"

namespace skerry::test::balance_test {

namespace {

/// A world with every exchange of momentum and energy with the outside: loads, gravity, a moving collider, a held and a
/// moving face, contact between bodies.
World busy_world(Real step_safety, Real damping = 0, const MaterialSettings& losses = {}) {
    World world = tuned_world({}, {.step_safety = step_safety});
    const auto rubber = world.add_material({.young_modulus = 5e4,
                                            .friction = 0.4,
                                            .damping = damping,
                                            .loss_factor = losses.loss_factor,
                                            .bulk_viscosity = losses.bulk_viscosity});
    world.add_collider(Plane{}, {.motion = {.velocity = {0.2, 0, 0.05}}});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
    const auto low = world.add_body(block, {.material = rubber, .position = {0, 0, 0.055}, .contact_distance = 0.002});
    world.add_body(
        block, {.material = rubber, .position = {0.02, 0, 0.2}, .velocity = {0, 0.3, -1}, .contact_distance = 0.002});
    const auto bar =
        world.add_body(mesh::box({0.4, 0.05, 0.05}, {8, 1, 1}), {.material = rubber, .position = {0, 1, 0.4}});
    std::vector<Index> left, right;
    const auto nodes = world.positions(bar);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n].x() < -0.19) left.push_back(static_cast<Index>(n));
        if (nodes[n].x() > 0.19) right.push_back(static_cast<Index>(n));
    }
    world.attach(bar, left);
    world.attach(bar, right, {.velocity = {0.1, 0, 0.2}, .angular_velocity = {1, 0, 0}});
    world.set_loads(low, std::vector<Vec3>(block.nodes.size(), Vec3(0.01, 0.02, 0)));
    return world;
}

}  // namespace

TEST_CASE("momentum adds up to rounding whatever exchanges it, energy to the error of the step", "[scene][long]") {
    const MaterialSettings usual, none = test::lossless({});
    for (const auto& [safety, losses, most] :
         {std::tuple{0.65, none, 1e-3},  // without losses the error is of second order in the step
          {0.5, none, 1e-3},
          {0.25, none, 1e-3},
          {1.0, usual, 1e-3},
          {0.25, usual, 1e-3}}) {
        World world = busy_world(safety, 0, losses);
        REQUIRE(world.advance(0.4).ok());
        const WorldReport report = world.report();
        CHECK(report.balanced_steps == report.steps);
        REQUIRE(report.mean_contacts > 5);
        REQUIRE(report.energy.dissipated > 0.1);
        // Rounding errors add up as a random walk.
        CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
        // The balance error is below the error of the steps themselves, since all energies are taken at one time.
        CHECK(report.energy_error_share < most);
    }
}

TEST_CASE("a change from outside starts the balance afresh, and a held body that is damped leaves the momentum open",
          "[scene]") {
    World world = busy_world(1);
    REQUIRE(world.advance(0.2).ok());
    const std::uint64_t before = world.report().balanced_steps;
    const BodyHandle first = world.bodies().front();
    world.set_velocities(first, std::vector<Vec3>(world.positions(first).size(), Vec3(0, 0, 3)));
    REQUIRE(world.advance(0.2).ok());
    const WorldReport report = world.report();
    CHECK(report.balanced_steps < report.steps - before + 1);
    CHECK(report.energy_error_share < 0.05);  // the change of velocity does not count as an error
    CHECK(report.momentum_error_share < 1e-12);

    World damped = busy_world(1, 5);
    REQUIRE(damped.advance(0.1).ok());
    CHECK(std::isnan(damped.report().momentum_error));
    CHECK(damped.report().energy_error_share < 5e-3);
}

TEST_CASE("weightless bodies at rest get no warning about energy errors of rounding", "[scene]") {
    Settings settings;
    settings.gravity.setZero();
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 7), Vec3(100, 0, 0)}) {
        World world(settings);
        const auto rubber = world.add_material({.young_modulus = 1e6});
        world.add_body(mesh::ball(0.1, 6), {.material = rubber, .position = place, .rotation = {0.3, 0.2, 0.1}});
        REQUIRE(world.advance(0.3).ok());
        CHECK(world.report().energy_error < 1e-12);
        CHECK(world.report().energy_error_share < 1e-3);
    }
}

TEST_CASE("motion that is small, but none of rounding, has the share of error that it has when it is large",
          "[scene]") {
    std::vector<Real> shares;
    for (const Real rate : {1e-3, 1e-7}) {  // strain rates [1/s]; the strains are about 1e-6 and 1e-10
        Settings settings;
        settings.gravity.setZero();
        World world(settings);
        const auto rubber = world.add_material({.young_modulus = 1e6, .damping = 50});
        const auto ball = world.add_body(mesh::ball(0.1, 6), {.material = rubber});
        std::vector<Vec3> velocity(world.positions(ball).begin(), world.positions(ball).end());
        for (Vec3& v : velocity) v *= rate;
        world.set_velocities(ball, velocity);
        REQUIRE(world.advance(0.02).ok());
        shares.push_back(world.report().energy_error_share);
    }
    CHECK(shares[0] > 1e-6);
    CHECK(shares[1] == Approx(shares[0]).epsilon(0.05));
}

TEST_CASE("rounding errors of large forces that squeeze a body are no error of the momentum balance", "[scene]") {
    // Both attachments together hold all nodes, so that the nearly incompressible pad cannot yield to the sides. The
    // holding forces cancel each other, and are much larger than all momenta.
    Settings settings;
    settings.gravity.setZero();
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e6, .poisson_ratio = 0.4999});
    const auto pad = world.add_body(mesh::cylinder(0.05, 0.025, 4), {.material = rubber});
    std::vector<Index> low, high;
    const auto nodes = world.positions(pad);
    for (std::size_t n = 0; n < nodes.size(); ++n) (nodes[n].z() < 0 ? low : high).push_back(static_cast<Index>(n));
    world.attach(pad, low);
    const auto press = world.attach(pad, high);
    world.move_to(press, {.position = {0, 0, -0.00025}}, 0.05);
    world.measure_forces(true);
    REQUIRE(world.advance(0.05).ok());
    REQUIRE(world.advance(0.01).ok());
    REQUIRE(world.forces().by(press).force().norm() > 1e5);
    CHECK(world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a load that changes, or is taken away, on a moving body keeps the balance", "[scene]") {
    const auto dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid);
    const auto integrator = GENERATE(Integrator::symplectic_euler, Integrator::leapfrog);
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = 1e-4;  // divides the intervals below, so that all steps are equally long
    settings.integrator = integrator;
    World world(settings);
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto rubber = world.add_material({});
    const auto body = world.add_body(cube, {.material = rubber, .velocity = {3, 0, 0}, .dynamics = dynamics});
    const std::vector<Real> mass = node_masses(world, body, cube, MaterialSettings{}.density);
    for (const Real acceleration : {10.0, -20.0, 5.0, 0.0, 0.0, 10.0, 0.0}) {
        std::vector<Vec3> load;
        for (const Real m : mass) load.push_back({m * acceleration, 0, 0});
        world.set_loads(body, load);
        REQUIRE(world.advance(0.01).ok());
        World copy = world.clone();
        CHECK(copy.report().energy_error_share == world.report().energy_error_share);
    }
    // Leapfrog books the work of a constant load with an error of h F dv / 2, at most 7e-5 of the energy here. Half a
    // step of work that is missing or too much would be 3e-4.
    CHECK(world.report().energy_error_share < (integrator == Integrator::leapfrog ? 1e-4 : 1e-10));
    CHECK(world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a report names the body and the element that turned inside out", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e4});
    world.add_body(mesh::ball(0.1, 3), {.material = rubber, .position = {1, 0, 0}});
    const Mesh one{.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
                   .tetrahedra = {{1, 2, 3, 4}, {0, 1, 2, 3}}};
    const auto body = world.add_body(one, {.material = rubber, .position = {5, 0, 0}, .name = "two tetrahedra"});
    CHECK(world.report().inverted == 0);
    const std::vector<Index> fixed{0, 1, 2}, led{3};
    world.attach(body, fixed);
    world.attach(body, led, {.velocity = {0.4, 0.4, -1.5}});  // moves the node through the face of the other three
    REQUIRE(world.advance(0.9).ok());
    const WorldReport report = world.report();
    CHECK(report.inverted >= 1);
    CHECK(report.near_inversion >= report.inverted);
    CHECK(report.worst_volume_body == "two tetrahedra");
    CHECK(report.worst_volume_element == 1);
    CHECK(report.worst_volume_ratio < 0);
}

using namespace filled_sphere;

TEST_CASE("a body that breathes on its gas keeps its energy", "[scene][cavities][balance][long]") {
    const Real stable = HollowSphere(pressurised, rubber()).world.stable_step();
    for (const Real share : {1.0, 0.25}) {
        CAPTURE(share);
        const Real tolerance = 0.05 * share * share;  // the error of leapfrog grows with the square of the step
        Settings settings = accurate(no_gravity);
        settings.integrator = Integrator::leapfrog;
        settings.step_size = share * stable;
        HollowSphere sphere(pressurised, rubber(), BodyDynamics::explicit_elastic, settings);
        const auto energy = [&] {
            const Energy& e = sphere.world.report().energy;
            return e.kinetic + e.elastic;
        };
        REQUIRE(sphere.world.advance(0.01).ok());
        const Real start = energy();
        for (int call = 0; call < 10; ++call) {
            REQUIRE(sphere.world.advance(share).ok());
            CHECK(energy() == Approx(start).epsilon(tolerance));
            CHECK(sphere.world.report().energy.elastic > 0);
        }
        CHECK(sphere.world.report().energy_error_share < tolerance);
    }
}

TEST_CASE("a piston exchanges its energy with a gas or a liquid without loss", "[scene][cavities][balance]") {
    constexpr Real side = 0.1, area = side * side, volume = 2e-3, mass = 1, speed = 1e-3;
    const auto [filling, stiffness] = GENERATE(
        std::pair<decltype(CavitySettings::filling), Real>(GasFilling{.exponent = 1.4}, 1.4 * standard_pressure),
        std::pair<decltype(CavitySettings::filling), Real>(GasFilling{.exponent = 1}, standard_pressure),
        std::pair<decltype(CavitySettings::filling), Real>(LiquidFilling{.bulk_modulus = 2e9}, 2e9));
    const Real period = 2 * std::numbers::pi / std::sqrt(stiffness * area * area / (mass * volume));
    Settings settings = accurate(no_gravity);
    settings.integrator = GENERATE(Integrator::leapfrog, Integrator::symplectic_euler);
    settings.step_size = period / 400;
    World world(settings);
    const BodyHandle piston = world.add_body(
        mesh::box({side, side, side}, {1, 1, 1}),
        {.material = world.add_material({}), .velocity = {speed, 0, 0}, .dynamics = BodyDynamics::rigid});
    Cavities(world).add({.body = piston,
                         .faces = faces_where(world, piston, [](const Vec3& x) { return x.x() > side / 2 - 1e-9; }),
                         .filling = filling,
                         .volume = volume});
    const Real start = world.report().energy.kinetic;
    for (int quarter = 1; quarter <= 8; ++quarter) {
        REQUIRE(world.advance(period / 4).ok());
        const Energy energy = world.report().energy;
        // at the quarters one of the two energies is at its maximum
        CHECK((quarter % 2 == 1 ? energy.elastic : energy.kinetic) == Approx(start).epsilon(1e-3));
        CHECK((quarter % 2 == 1 ? energy.kinetic : energy.elastic) < 1e-3 * start);
    }
    CHECK(world.report().energy_error_share < 1e-4);
}

TEST_CASE("the balance of energy holds for a ball of gas that bounces, and counts added gas and liquid as work",
          "[scene][cavities][balance]") {
    const BodyDynamics dynamics =
        GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid);
    CAPTURE(dynamics);
    const auto energy_error = [&](const decltype(CavitySettings::filling)& filling, auto&& change) {
        // a quarter of the stable step, because the error of the balance grows with the square of the step
        Settings settings = accurate(no_gravity);
        settings.step_size = HollowSphere(filling, rubber()).world.stable_step() / 4;
        HollowSphere sphere(filling, rubber(), dynamics, settings);
        sphere.world.add_collider(Plane{.point = {0, 0, -0.101}});
        sphere.world.set_velocity(sphere.body, {0.1, 0, -1});
        change(sphere, Cavities(sphere.world));
        REQUIRE(sphere.world.advance(0.05).ok());
        return sphere.world.report().energy_error_share;
    };
    CHECK(energy_error(pressurised, [](HollowSphere&, Cavities) {}) < 1e-3);
    CHECK(energy_error(pressurised, [](HollowSphere& sphere, Cavities cavities) {
              cavities.add({.first = sphere.cavity, .conductance = 1e-7});
          }) < 1e-3);
    CHECK(energy_error(pressurised, [](HollowSphere& sphere, Cavities cavities) {
              cavities.set_inflow(sphere.cavity, {{{0, 0}, {0.05, 2e-3}}});
          }) < 1e-3);
    CHECK(energy_error(LiquidFilling{.bulk_modulus = 1e6}, [](HollowSphere& sphere, Cavities cavities) {
              const Real volume = sphere.state().volume;
              cavities.set_liquid_volume(sphere.cavity, {{{0, volume}, {0.05, 1.02 * volume}}});
          }) < 1e-3);
}

TEST_CASE("a cavity that is added between calls, or whose liquid changes there, is no error of the balance",
          "[scene][cavities][balance]") {
    const LiquidFilling water{.bulk_modulus = 1e6};
    const auto energy_error = [&](auto&& change) {
        Settings settings = accurate(no_gravity);
        settings.step_size = HollowSphere(water, rubber()).world.stable_step() / 4;
        HollowSphere sphere(water, rubber(), BodyDynamics::explicit_elastic, settings);
        sphere.world.set_velocity(sphere.body, {0.1, 0, 0});
        REQUIRE(sphere.world.advance(0.01).ok());
        change(sphere, Cavities(sphere.world));
        REQUIRE(sphere.world.advance(0.01).ok());
        return sphere.world.report().energy_error_share;
    };
    CHECK(energy_error([](HollowSphere& sphere, Cavities cavities) {
              cavities.remove(sphere.cavity);
              REQUIRE(sphere.world.advance(0.01).ok());
              cavities.add({.body = sphere.body, .filling = pressurised});
          }) < 1e-3);
    CHECK(energy_error([](HollowSphere& sphere, Cavities cavities) {
              cavities.set_liquid_volume(sphere.cavity, 1.01 * sphere.state().volume);
          }) < 1e-3);
}

}  // namespace skerry::test::balance_test
