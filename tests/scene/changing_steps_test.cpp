// Symplectic Euler with steps of changing length (docs/methods/time_stepping.md 1.5).
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "engine/world/world_state.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::changing_steps_test {

namespace {

/// A fraction of the step between 0.5 and 1, without a pattern.
Real part_of_step(int step) {
    return 0.5 + 0.5 * std::fmod(step * std::numbers::phi, 1);
}

/// Length of the force interval (kick) in the last step [s]
Real kick_of(const World& world) {
    return WorldAccess::state_of(world).scratch.parameters.kick_time;
}

/// Makes one step of length h.
void take(World& world, Real h) {
    const StepReport report = world.advance(h);
    REQUIRE(report.ok());
    REQUIRE(report.steps == 1);
}

Settings step_of(Real h) {
    Settings settings = accurate();
    settings.step_size = h;
    return settings;
}

}  // namespace

TEST_CASE("a fast swing with short steps keeps its energy", "[scene]") {
    // One tetrahedron with three held nodes: the fourth oscillates along z with omega^2 = 4 (lambda + 2 mu) / rho.
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto material = world.add_material(
        lossless({.young_modulus = 1e5, .poisson_ratio = 0.25, .density = 1000, .model = MaterialModel::linear}));
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    const auto body = world.add_body(mesh, {.material = material});
    world.attach(body, std::vector<Index>{0, 1, 2});
    const Real omega = std::sqrt(4 * 3 * 4e4 / 1000), start_speed = 0.01;
    world.set_velocities(body, std::vector<Vec3>{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), {0, 0, start_speed}});

    constexpr Real longest = 0.1;  // in units of 1/omega
    for (const Real end = 20 * 2 * std::numbers::pi / omega; world.time() < end;) {
        const Real speed = world.velocities(body)[3].z() / start_speed;
        take(world, longest / omega * (1 - 0.5 * std::min<Real>(1, speed * speed)));
    }
    const Real place = omega * (world.positions(body)[3].z() - 1) / start_speed;
    const Real speed = world.velocities(body)[3].z() / start_speed -
                       omega * WorldAccess::state_of(world).clock.step_before / 2 * place;
    // The step depends on the speed half a step earlier, the strongest asymmetry: (omega h)^2 per period. With force
    // intervals (kicks) as long as the steps, 0.39 of the energy would be left.
    CHECK(place * place + speed * speed == Approx(1).margin(0.02));
}

TEST_CASE("a fall is a parabola whatever its steps", "[scene]") {
    const BodyDynamics kind = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid);
    INFO(name_of(kind));
    World world(step_of(4e-3));
    const auto material = world.add_material(lossless({.young_modulus = 1e4, .poisson_ratio = 0.3, .density = 1000}));
    const Vec3 velocity(0.3, 0, 2);
    const auto body = world.add_body(mesh::box({0.2, 0.2, 0.2}, {1, 1, 1}),
                                     {.material = material, .velocity = velocity, .dynamics = kind});
    const Vec3 start = world.center_of_mass(body), g = world.settings().gravity;
    const Real first = 4e-3 * part_of_step(1);
    for (int step = 1; step <= 100; ++step) {
        take(world, 4e-3 * part_of_step(step));
        // The start velocity counts as that of half a step before the start.
        const Real t = world.time();
        const Vec3 expected = start + t * (velocity + first / 2 * g) + t * t / 2 * g;
        REQUIRE((world.center_of_mass(body) - expected).norm() < 1e-14 * (1 + step));
    }
}

TEST_CASE("contacts carry the weight in every step whatever its length, and so do sums of forces", "[scene]") {
    World world(step_of(4e-3));
    const auto material = world.add_material(
        {.young_modulus = 1e4, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5, .restitution = 0});
    const auto floor = world.add_collider(Plane{});
    const auto body = world.add_body(
        mesh::box({0.2, 0.2, 0.2}, {1, 1, 1}),
        {.material = material, .position = {0, 0, 0.1005}, .contact_distance = 1e-3, .dynamics = BodyDynamics::rigid});
    REQUIRE(world.advance(0.5).ok());
    world.measure_forces(true);
    const Real weight = world.mass(body) * standard_gravity;
    for (int step = 1; step <= 30; ++step) {
        take(world, 4e-3 * part_of_step(step));
        Real carried = 0;
        for (const Contact& contact : world.contacts()) carried += contact.force().z();
        CHECK(carried == Approx(weight).epsilon(1e-6));
        const ForceReport on = world.forces().on(body, floor);
        CHECK(on.force().z() == Approx(weight).epsilon(1e-6));
        CHECK(on.largest_force == Approx(weight).epsilon(1e-6));
    }
}

TEST_CASE("energy and momentum add up while steps change, with loads, held nodes and contacts", "[scene]") {
    const BodyDynamics kind =
        GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    const bool held = GENERATE(false, true);
    INFO(name_of(kind) << (held ? ", led" : ", loaded"));
    World world(step_of(1e-3));
    const auto material = world.add_material(lossless({.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000}));
    const Mesh mesh = mesh::box({0.2, 0.2, 0.2}, {2, 2, 2});
    const auto body = world.add_body(mesh, {.material = material, .dynamics = kind});
    if (held) {
        std::vector<Index> top;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (mesh.nodes[n].z() > 0.09) top.push_back(static_cast<Index>(n));
        world.attach(body, top, {.velocity = {0, 0, 0.4}, .angular_velocity = {0, 0, 0.5}});
    } else {
        world.set_loads(body, std::vector<Vec3>(mesh.nodes.size(), Vec3(0.1, 0, 1)));
    }
    for (int step = 1; step <= 400; ++step) take(world, 1e-3 * part_of_step(step));
    const WorldReport report = world.report();
    CHECK(report.momentum_error_share < 1e-12);
    CHECK(report.energy_error_share < 1e-3);
}

TEST_CASE("forces act from the middle of the step before to the middle of the step, tries that are given up apart",
          "[scene]") {
    World world{accurate()};
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.4, .density = 1000});
    world.add_collider(Plane{});
    world.add_body(mesh::ball(0.1, 4), {.material = rubber, .position = {0, 0, 0.11}, .velocity = {0, 0, -15}});
    Real before = 0;
    int changed = 0, given_up = 0;
    world.watch_steps([&](const StepReport& report) {
        const Real h = report.step_size;
        CHECK(kick_of(world) == (before > 0 ? (before + h) / 2 : h));
        changed += before > 0 && std::abs(h / before - 1) > 0.01;
        given_up = report.shortened + report.retried;
        before = h;
    });
    REQUIRE(world.advance(0.02).ok());
    CHECK(changed > 10);
    CHECK(given_up > 0);
}

TEST_CASE("steps that are all alike have kicks as long", "[scene]") {
    World world{step_of(0x1p-10)};
    const auto rubber = world.add_material({.young_modulus = 1e4, .poisson_ratio = 0.4, .density = 1000});
    world.add_body(mesh::ball(0.1, 3), {.material = rubber});
    world.watch_steps([&](const StepReport& report) { CHECK(kick_of(world) == report.step_size); });
    for (int call = 0; call < 4; ++call) REQUIRE(world.advance(0x1p-6).steps == 16);
}

TEST_CASE("leapfrog kicks for the step itself, however long the last one was", "[scene]") {
    Settings settings = step_of(1e-3);
    settings.integrator = Integrator::leapfrog;
    World world{settings};
    const auto rubber = world.add_material({.young_modulus = 1e4, .poisson_ratio = 0.4, .density = 1000});
    world.add_body(mesh::ball(0.1, 3), {.material = rubber});
    for (int step = 1; step <= 10; ++step) {
        const Real h = 1e-3 * part_of_step(step);
        take(world, h);
        CHECK(kick_of(world) == h);
    }
}

TEST_CASE("a body with a much shorter stable step gets no kick from the length of the last step", "[scene]") {
    World world{Settings{}};
    const auto stone = world.add_material({.young_modulus = 1e9, .poisson_ratio = 0.3, .density = 2000});
    world.add_body(mesh::ball(0.1, 3), {.material = stone, .dynamics = BodyDynamics::rigid});
    REQUIRE(world.advance(0.1).ok());
    const Real long_step = WorldAccess::state_of(world).clock.step_before;
    const auto rubber = world.add_material(lossless({.young_modulus = 1e8, .poisson_ratio = 0.3, .density = 1000}));
    const Mesh mesh = mesh::box({0.2, 0.2, 0.2}, {3, 3, 3});
    const auto body =
        world.add_body(mesh, {.material = rubber, .position = {1, 0, 0}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Vec3> strained(world.positions(body).begin(), world.positions(body).end());
    for (Vec3& x : strained) x.x() += 0.02 * (x.x() - 1);
    world.set_positions(body, strained);
    const Real stable = world.stable_step();
    REQUIRE(long_step > 20 * stable);
    const Energy before = world.energy();
    const StepReport report = world.advance(stable / 2);
    REQUIRE(report.ok());
    CHECK(kick_of(world) <= 1.5 * stable);
    REQUIRE(world.advance(20 * stable).ok());
    const Energy after = world.energy();
    // Part of it comes from a force interval (kick) of 1.2 stable steps on a strained body. One of half the last step
    // would give 1600 times the energy.
    CHECK(after.elastic + after.kinetic - before.kinetic < 4 * before.elastic);
}

TEST_CASE("a world that was cloned, or saved and loaded, knows how long its last step was", "[scene]") {
    const TemporaryFolder folder;
    World world{step_of(1e-3)};
    const auto rubber = world.add_material({.young_modulus = 1e4, .poisson_ratio = 0.4, .density = 1000});
    world.add_collider(Plane{});
    const auto body = world.add_body(mesh::ball(0.1, 3), {.material = rubber, .position = {0, 0, 0.101}});
    REQUIRE(world.advance(0.05).ok());
    take(world, 7e-4);
    World twin = world.clone();
    world.save(folder.path() / "world.skerry");
    World loaded = World::load(folder.path() / "world.skerry");
    for (World* each : {&world, &twin, &loaded}) take(*each, 3e-4);
    CHECK(kick_of(world) == Approx(5e-4));
    CHECK(twin.state_hash() == world.state_hash());
    CHECK(loaded.state_hash() == world.state_hash());
    REQUIRE(world.contacts().size() > 0);
    CHECK(loaded.contacts()[0].force() == world.contacts()[0].force());
    CHECK(loaded.report().energy_error_share == world.report().energy_error_share);
    CHECK(world.positions(body)[0] == loaded.positions(body)[0]);
}

}  // namespace skerry::test::changing_steps_test
