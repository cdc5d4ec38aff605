// Bodies that a user drags by a spring, against the closed form of a critically damped spring.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/live/pull.h"
#include "tests/support/message_of.h"
#include "tests/support/worlds.h"

namespace skerry::test::pull_test {

using Catch::Matchers::Contains;

namespace {

const Real rate = 4 * std::numbers::pi;  // circular frequency of the spring [rad/s]

/// A cube of 2 cm without gravity at the origin, that moves with the given velocity.
struct Cube {
    World world;
    BodyHandle body;

    explicit Cube(BodyDynamics dynamics, const Vec3& velocity = Vec3::Zero(),
                  const Settings& settings = accurate(Vec3::Zero()))
        : world(settings) {
        const auto material = world.add_material(lossless({.young_modulus = 1e6, .density = 1000}));
        body = world.add_body(mesh::box({0.02, 0.02, 0.02}, {2, 2, 2}),
                              {.material = material, .velocity = velocity, .dynamics = dynamics, .name = "cube"});
    }
    Vec3 center() const { return world.center_of_mass(body); }
    void advance(Real time) {
        for (int call = 0; call < 20; ++call) REQUIRE(world.advance(time / 20).ok());
    }
};

std::size_t steps_in(World& world, Real time) {
    const StepReport report = world.advance(time);
    REQUIRE(report.ok());
    return static_cast<std::size_t>(report.steps);
}

}  // namespace

TEST_CASE("a pulled body approaches the target as a critically damped mass, from the side as well", "[scene]") {
    const BodyDynamics dynamics =
        GENERATE(BodyDynamics::rigid, BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic);
    INFO(name_of(dynamics));
    Settings settings = accurate(Vec3::Zero());
    settings.step_size = 5e-4;
    const Vec3 velocity(0, 0.8, 0), target(0, 0, 0.3), point(0, 0, 0.01);
    Cube cube(dynamics, velocity, settings);
    Pull pull;
    pull.begin(cube.world, cube.body, point, target);
    CHECK(pull.state(cube.world)->length == Approx(0.29));
    for (const Real time : {0.1, 0.2, 0.4}) {
        cube.advance(time - cube.world.time());
        const Vec3 start = point - target;
        const Vec3 expected = target + (start + (velocity + rate * start) * time) * std::exp(-rate * time);
        // The pulled point is up to 1 cm beside the centre of mass, because the cube turns into the pull.
        CHECK((cube.center() - expected).norm() < 0.011);
        const Real force = cube.world.mass(cube.body) * rate * rate * pull.state(cube.world)->length;
        CHECK(pull.state(cube.world)->force == Approx(force).epsilon(0.03));
    }
    CHECK(cube.world.report().energy_error_share < 0.01);
    CHECK(cube.world.report().momentum_error_share < 1e-9);
}

TEST_CASE("the force of a pull is at most 50 weights, and ends exactly when the pull ends", "[scene]") {
    Cube cube(BodyDynamics::rigid);
    const std::uint64_t before = cube.world.state_hash();
    Pull pull;
    pull.begin(cube.world, cube.body, {0, 0, 0.01}, {0, 0, 20});
    CHECK(cube.world.state_hash() != before);
    pull.end(cube.world);
    CHECK(cube.world.state_hash() == before);
    CHECK(!pull.state(cube.world));

    pull.begin(cube.world, cube.body, {0, 0, 0.01}, {0, 0, 20});
    REQUIRE(cube.world.advance(1e-3).ok());
    CHECK(pull.state(cube.world)->force == Approx(50 * 9.81 * cube.world.mass(cube.body)));
    CHECK(cube.center().z() > 0);
    pull.end(cube.world);
    CHECK(Springs(cube.world).all().empty());
    CHECK(Loads(cube.world).all().empty());
    const Real z = cube.center().z();
    REQUIRE(cube.world.advance(1e-3).ok());
    const Real moved = cube.center().z() - z;
    REQUIRE(cube.world.advance(1e-3).ok());
    CHECK(cube.center().z() == Approx(z + 2 * moved));
}

TEST_CASE("the target of a pull moves, and two pulls hold a body between their targets", "[scene]") {
    Cube cube(BodyDynamics::rigid);
    Pull pull, other;
    pull.begin(cube.world, cube.body, {0.5, 0, 0}, {0.1, 0, 0});  // the nearest surface point is pulled
    CHECK(pull.state(cube.world)->length == Approx(0.09));
    pull.move(cube.world, {0.3, 0, 0});
    CHECK(pull.state(cube.world)->length == Approx(0.29));
    other.begin(cube.world, cube.body, {-0.01, 0, 0}, {-0.1, 0, 0});
    cube.advance(2);
    CHECK(cube.center().isApprox(Vec3(0.1, 0, 0), 1e-3));
    CHECK_THAT(message_of([&] { pull.move(cube.world, Vec3::Constant(std::nan(""))); }), Contains("nan"));
    CHECK_THAT(message_of([&] {
                   pull.move(cube.world, {0, 1e155, 0});
               }),
               Contains("pull: to: found (0, 1e+155, 0), expected coordinates between"));
    CHECK_THAT(message_of([&] { pull.begin(cube.world, cube.body, Vec3::Zero(), {0, 0, 1e300}); }), Contains("to"));
    CHECK_THAT(message_of([&] { pull.begin(cube.world, cube.body, {1e300, 0, 0}, Vec3::Zero()); }), Contains("point"));
    CHECK(pull.state(cube.world)->length == Approx(0.19).epsilon(1e-3));
    pull.begin(cube.world, cube.body, {0.11, 0, 0}, {0.2, 0, 0});  // replaces the first pull
    CHECK(Springs(cube.world).all().size() == 2);
    cube.world.remove(cube.body);
    CHECK(!pull.state(cube.world));
    pull.move(cube.world, Vec3::Zero());
    pull.end(cube.world);
    CHECK_THAT(message_of([&] { pull.begin(cube.world, cube.body, Vec3::Zero(), Vec3::Zero()); }), Contains("body"));
}

TEST_CASE("a reset to a clone without the pull ends the pull", "[scene]") {
    Cube cube(BodyDynamics::explicit_elastic);
    const World saved = cube.world.clone();
    Pull pull;
    pull.begin(cube.world, cube.body, {0, 0, 0.01}, {0, 0, 0.2});
    cube.advance(0.05);
    cube.world.reset(saved);
    CHECK(!pull.state(cube.world));
    pull.end(cube.world);
    CHECK(cube.world.state_hash() == saved.state_hash());
}

TEST_CASE("a pull goes on when the owner of the world removes one of its springs", "[scene]") {
    World world(accurate(Vec3::Zero()));
    const auto material = world.add_material({.young_modulus = 1e5, .density = 1000});
    const BodyHandle ball = world.add_body(mesh::ball(0.1, 4), {.material = material});
    Pull pull;
    pull.begin(world, ball, {0, 0, 0.1}, {0, 0, 0.3});
    Springs springs(world);
    const std::vector<SpringHandle> all = springs.all();
    REQUIRE(all.size() > 2);
    springs.remove(all[GENERATE(std::size_t{0}, std::size_t{1})]);
    REQUIRE(world.advance(1e-3).ok());
    Real force = 0;
    for (const SpringHandle spring : springs.all()) force += springs.state(spring).force;
    REQUIRE(pull.state(world));
    CHECK(pull.state(world)->force == Approx(force));
    pull.end(world);
    CHECK(springs.all().empty());
}

TEST_CASE("a step that is refused during a pull changes nothing, and the pull goes on", "[scene]") {
    Cube cube(BodyDynamics::explicit_elastic);
    Pull pull;
    pull.begin(cube.world, cube.body, {0, 0, 0.01}, {0, 0, 0.2});
    REQUIRE(cube.world.advance(0.01).ok());
    const std::vector<Vec3> before(cube.world.positions(cube.body).begin(), cube.world.positions(cube.body).end());
    const Real force = pull.state(cube.world)->force;
    std::vector<Vec3> load(before.size(), Vec3(0, 0, 1e308));
    cube.world.set_loads(cube.body, load);
    REQUIRE_FALSE(cube.world.advance(0.01).ok());
    CHECK(std::ranges::equal(cube.world.positions(cube.body), before));
    CHECK(pull.state(cube.world)->force == force);
    load.assign(load.size(), Vec3::Zero());
    cube.world.set_loads(cube.body, load);
    cube.advance(1);
    CHECK(cube.center().isApprox(Vec3(0, 0, 0.19), 1e-2));
    pull.end(cube.world);
    CHECK(Springs(cube.world).all().empty());
}

TEST_CASE("a pull wakes a sleeping body, lifts it, and does not pull it through the floor", "[scene]") {
    Settings settings;
    settings.sleep_time = 0.05;
    World world(settings);
    const auto material = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 20});
    const BodyHandle cube = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                           {.material = material, .position = {0, 0, 0.05}, .name = "cube"});
    world.add_collider(Plane{}, {});
    for (int call = 0; call < 100 && !world.asleep(cube); ++call) REQUIRE(world.advance(0.05).ok());
    REQUIRE(world.asleep(cube));
    Pull pull;
    pull.begin(world, cube, {0, 0, 0.1}, {0, 0, 0.3});
    CHECK(!world.asleep(cube));
    REQUIRE(world.advance(1).ok());
    // The weight stretches the spring by g / rate^2. The pulled point lies above the centre of mass.
    CHECK(world.center_of_mass(cube).z() == Approx(0.25 - 9.81 / (rate * rate)).margin(0.01));
    pull.move(world, {0, 0, -5});
    REQUIRE(world.advance(0.5).ok());
    for (const Vec3& x : world.positions(cube)) CHECK(x.z() > -1e-3);
}

TEST_CASE("a pull at a body that an attachment holds is stable and gives the body back", "[scene]") {
    World world(accurate(Vec3::Zero()));
    const auto material = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 10});
    const BodyHandle bar = world.add_body(mesh::box({0.3, 0.05, 0.05}, {6, 1, 1}), {.material = material});
    std::vector<Index> end;
    for (std::size_t n = 0; n < world.positions(bar).size(); ++n)
        if (world.positions(bar)[n].x() < -0.149) end.push_back(static_cast<Index>(n));
    world.attach(bar, end);
    const Vec3 before = world.center_of_mass(bar);
    Pull pull;
    pull.begin(world, bar, {0.15, 0, 0}, {0.15, 0, 0.1});
    REQUIRE(world.advance(1).ok());
    CHECK(world.center_of_mass(bar).z() > 0.001);
    pull.begin(world, bar, {-0.15, 0, 0}, {-5, 0, 0});  // at the attachment
    REQUIRE(world.advance(0.5).ok());
    CHECK(pull.state(world)->force == Approx(50 * 9.81 * world.mass(bar)));
    pull.end(world);
    REQUIRE(world.advance(2).ok());  // the first mode is damped nearly critically
    CHECK((world.center_of_mass(bar) - before).norm() < 1e-3);
}

TEST_CASE("a pull adds at most 5 % of steps for an explicit fine mesh, and 30 % for an implicit one", "[scene]") {
    const BodyDynamics dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic);
    World world(accurate(Vec3::Zero()));
    const auto material = world.add_material({.young_modulus = 1e5, .density = 1000});
    const BodyHandle ball = world.add_body(mesh::ball(0.1, 8), {.material = material, .dynamics = dynamics});
    const std::size_t before = steps_in(world, 0.1);
    Pull pull;
    pull.begin(world, ball, {0, 0, 0.1}, {0, 0, 0.3});
    const std::size_t pulled = steps_in(world, 0.1);
    INFO(name_of(dynamics) << ": " << before << " and " << pulled << " steps");
    const Real most = dynamics == BodyDynamics::explicit_elastic ? 1.05 : 1.3;
    CHECK(static_cast<Real>(pulled) <= most * static_cast<Real>(before) + 1);
}

TEST_CASE("a pull at an implicit body with theta below 1 is refused with the reason", "[scene]") {
    Settings settings = accurate(Vec3::Zero());
    settings.theta = 0.55;
    Cube cube(BodyDynamics::implicit_elastic, Vec3::Zero(), settings);
    Pull pull;
    CHECK_THAT(message_of([&] { pull.begin(cube.world, cube.body, Vec3::Zero(), Vec3::Zero()); }), Contains("theta"));
    CHECK(!pull.state(cube.world));
}

}  // namespace skerry::test::pull_test
