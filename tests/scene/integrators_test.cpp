// Orders of the integrators, measured against closed forms and against very small steps (docs/methods/time_stepping.md
// 1).
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>

#include "tests/support/worlds.h"

namespace skerry::test::integrators_test {

namespace {

/// One tetrahedron with three held bottom nodes. The gradient of the fourth shape function is along z. It oscillates
/// there with m x'' = -V (lambda + 2 mu) g^2 x, V g^2 / m = 4 / rho for unit edges: one mode, in closed form.
struct Oscillator {
    World world;
    BodyHandle body;
    Real omega = 0;  // 1/s
    static constexpr Real start_speed = 0.01;

    Oscillator(Integrator integrator, Real step, Real damping = 0) : world(settings_of(integrator, step)) {
        const Real modulus = 1e5, poisson = 0.25, density = 1000;
        const Real mu = modulus / (2 * (1 + poisson)), lambda = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson));
        const auto material = world.add_material(test::lossless({.young_modulus = modulus,
                                                                 .poisson_ratio = poisson,
                                                                 .density = density,
                                                                 .damping = damping,
                                                                 .model = MaterialModel::linear}));
        Mesh mesh;
        mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        mesh.tetrahedra = {{0, 1, 2, 3}};
        body = world.add_body(mesh, {.material = material});
        world.attach(body, std::vector<Index>{0, 1, 2});
        world.set_velocities(body,
                             std::vector<Vec3>{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3(0, 0, start_speed)});
        omega = std::sqrt(4 * (lambda + 2 * mu) / density);
    }

    static Settings settings_of(Integrator integrator, Real step) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.step_size = step;
        settings.integrator = integrator;
        return settings;
    }
    Real amplitude() const { return start_speed / omega; }
    Real position() const { return world.positions(body)[3].z() - 1; }
    Real speed() const { return world.velocities(body)[3].z(); }
    /// Distance from the closed form in the plane of position and speed, as a fraction of the amplitude.
    Real error(Real t) const {
        return std::hypot(position() / amplitude() - std::sin(omega * t), speed() / start_speed - std::cos(omega * t));
    }
};

constexpr Real run_length = 0.5;  // about two periods [s]

Real oscillator_error(Integrator integrator, int steps) {
    Oscillator one(integrator, run_length / steps);
    REQUIRE(one.world.advance(run_length).steps == steps);
    return one.error(run_length);
}

/// A neo-Hookean block that rotates and vibrates, a fully nonlinear case.
std::vector<Vec3> block_after(Integrator integrator, int steps, bool in_one_call = true) {
    Settings settings;
    settings.gravity = {0, 0, -9.81};
    const Real seconds = 0.05;
    settings.step_size = seconds / steps;
    settings.integrator = integrator;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 2e4, .poisson_ratio = 0.3}));
    const Mesh mesh = mesh::box({0.2, 0.1, 0.1}, {3, 2, 2});
    const auto body = world.add_body(mesh, {.material = material, .angular_velocity = {0, 3, 4}});
    std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
    for (std::size_t n = 0; n < velocity.size(); ++n)
        velocity[n] += 4 * Vec3(mesh.nodes[n].x(), -mesh.nodes[n].y(), mesh.nodes[n].x());
    world.set_velocities(body, velocity);
    if (in_one_call) {
        REQUIRE(world.advance(seconds).steps == steps);
    } else {
        for (int frame = 0; frame < 10; ++frame) REQUIRE(world.advance(seconds / 10).ok());
    }
    std::vector<Vec3> state(world.positions(body).begin(), world.positions(body).end());
    const Real time_scale = 0.01;  // converts velocities to lengths [s]
    for (const Vec3& v : world.velocities(body)) state.push_back(time_scale * v);
    return state;
}

Real distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
    return std::sqrt(sum / static_cast<Real>(a.size()));
}

/// Height and mean velocity of a block after it was thrown onto the floor and has left it again.
struct Rebound {
    Real height = 0, velocity = 0;
};
Rebound rebound(Integrator integrator, int steps) {
    Settings settings;
    const Real seconds = 0.2;
    settings.step_size = seconds / steps;
    settings.integrator = integrator;
    settings.tolerance = 1e-10;
    World world(settings);
    world.add_collider(Plane{});
    const auto material =
        world.add_material(test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3, .friction = 0}));
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto body = world.add_body(mesh, {.material = material, .position = {0, 0, 0.09}, .velocity = {0, 0, -1}});
    REQUIRE(world.advance(seconds).ok());
    REQUIRE(world.report().max_contacts > 0);
    return {world.center_of_mass(body).z(), mean_velocity(world, body, node_masses(world, body, mesh, 1000)).z()};
}

}  // namespace

TEST_CASE("one mode converges with order 1 by symplectic Euler and with order 2 by leapfrog", "[scene]") {
    for (const auto& [integrator, order] :
         {std::pair{Integrator::symplectic_euler, 1.0}, std::pair{Integrator::leapfrog, 2.0}}) {
        INFO(name_of(integrator));
        const Real coarse = oscillator_error(integrator, 400), middle = oscillator_error(integrator, 800),
                   fine = oscillator_error(integrator, 1600);
        // At the coarsest step the second term of symplectic Euler's error is omega h = 0.03 of the first. Its order is
        // only that accurate.
        CHECK(std::log2(coarse / middle) == Approx(order).margin(0.03));
        CHECK(std::log2(middle / fine) == Approx(order).margin(0.015));
    }
}

TEST_CASE("leapfrog has the closed frequency error of a sampled oscillation", "[scene]") {
    // sin(omega_h h / 2) = omega h / 2: after a time t the phase is ahead by omega t (omega h)^2 / 24.
    const int steps = 200;
    Oscillator one(Integrator::leapfrog, run_length / steps);
    REQUIRE(one.world.advance(run_length).ok());
    const Real wh = one.omega * run_length / steps;
    const Real phase = 2 * steps * std::asin(wh / 2);
    CHECK(one.speed() / Oscillator::start_speed == Approx(std::cos(phase)).margin(1e-10));
}

TEST_CASE("a ringing block converges with order 1 by symplectic Euler and with order 2 by leapfrog", "[scene]") {
    const std::vector<Vec3> reference = block_after(Integrator::leapfrog, 6400);
    for (const auto& [integrator, order] :
         {std::pair{Integrator::symplectic_euler, 1.0}, std::pair{Integrator::leapfrog, 2.0}}) {
        INFO(name_of(integrator));
        const Real coarse = distance(block_after(integrator, 100), reference),
                   middle = distance(block_after(integrator, 200), reference),
                   fine = distance(block_after(integrator, 400), reference);
        CHECK(std::log2(coarse / middle) == Approx(order).margin(0.2));
        CHECK(std::log2(middle / fine) == Approx(order).margin(0.1));
    }
}

TEST_CASE("leapfrog gives the same states to rounding when a run is cut into calls", "[scene]") {
    CHECK(distance(block_after(Integrator::leapfrog, 200), block_after(Integrator::leapfrog, 200, false)) < 1e-12);
}

TEST_CASE("leapfrog keeps order 2 when the length of the step changes all the time", "[scene]") {
    const auto error = [](int pairs) {
        Oscillator one(Integrator::leapfrog, 1);
        for (int i = 0; i < pairs; ++i) {
            REQUIRE(one.world.advance(0.3 * run_length / pairs).steps == 1);
            REQUIRE(one.world.advance(0.7 * run_length / pairs).steps == 1);
        }
        return one.error(run_length);
    };
    CHECK(std::log2(error(100) / error(200)) == Approx(2).margin(0.05));
}

TEST_CASE("after an impact symplectic Euler converges with order 1 and leapfrog no slower", "[scene][long]") {
    // The moment of first contact within a step varies with the step length, and the errors with it. The order is
    // therefore taken over a factor of eight. A single soft contact leaves leapfrog nearly its second order; only
    // order 1 is required.
    const Rebound reference = rebound(Integrator::leapfrog, 25600);
    std::array<Real, 2> order{};
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        const Real coarse = std::abs(rebound(integrator, 800).height - reference.height);
        const Real fine = std::abs(rebound(integrator, 6400).height - reference.height);
        order[integrator == Integrator::leapfrog] = std::log2(coarse / fine) / 3;
    }
    CHECK(order[0] > 0.8);
    CHECK(order[0] < 1.2);
    CHECK(order[1] > 1);
}

TEST_CASE("a body in free fall by leapfrog is where it should be, not only nearly", "[scene]") {
    Settings settings;
    settings.step_size = 1e-2;
    settings.integrator = Integrator::leapfrog;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 1e3}));
    const auto body = world.add_body(mesh::box({1, 1, 1}, {1, 1, 1}), {.material = material, .velocity = {1, 0, 2}});
    REQUIRE(world.advance(0.4).ok());
    const Vec3 expected = Vec3(1, 0, 2) * 0.4 + Vec3(0, 0, -standard_gravity) * 0.08;
    CHECK((world.center_of_mass(body) - expected).norm() < 1e-12);
    CHECK((world.velocities(body)[0] - Vec3(1, 0, 2 - 0.4 * standard_gravity)).norm() < 1e-12);
}

TEST_CASE("a step that leapfrog cannot take leaves every bit as it was", "[scene]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    settings.step_size = 1e-4;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 1e5}));
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto body = world.add_body(mesh, {.material = material, .velocity = {0.3, 0.1, 0}});
    REQUIRE(world.advance(0.01).ok());
    std::vector<Vec3> huge(mesh.nodes.size(), Vec3::Zero());
    huge[3] = {1e300, 1e300, 0};
    world.set_loads(body, huge);
    const std::uint64_t before = world.state_hash();
    CHECK_FALSE(world.advance(0.01).ok());
    CHECK(world.state_hash() == before);
}

TEST_CASE("a block on a scripted floor rests on it by leapfrog, and the floor is where its script says", "[scene]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 1e5, .damping = 20}));
    Motion up;
    up.velocity = {0, 0, 0.1};
    world.add_collider(Plane{}, {.motion = up});
    const auto body = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                     {.material = material, .position = {0, 0, 0.051}, .contact_distance = 0.002});
    REQUIRE(world.advance(1).ok());
    CHECK(world.time() == Approx(1));
    Real lowest = 1;
    for (const Vec3& x : world.positions(body)) lowest = std::min(lowest, x.z());
    CHECK(lowest == Approx(0.101).margin(2e-4));  // floor at 0.1, half the contact shell above; a step moves it by 1e-4
    CHECK(mean_velocity(world, body, node_masses(world, body, mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), 1000)).z() ==
          Approx(0.1).margin(1e-3));
}

}  // namespace skerry::test::integrators_test
