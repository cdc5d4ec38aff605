// Sleeping bodies: they are left out of the step, and every relevant change wakes them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numbers>

#include "engine/world/tuning.h"
#include "skerry/joint.h"
#include "tests/support/worlds.h"

namespace skerry::test::sleep_test {

namespace {

constexpr Real sleep_speed = 5e-3;  // m/s
constexpr Real sleep_time = 0.1;    // s
constexpr Real own_limits = -1;     // in place of a speed: use the engine's own limits

/// A tower of two blocks on a plane, and a block beside it.
struct Tower {
    World world;
    BodyHandle low, high, beside;
    ColliderHandle floor;
    Mesh block;
    MaterialHandle rubber;

    explicit Tower(Real speed = sleep_speed, int threads = 1, std::array<int, 3> cells = {3, 3, 2})
        : world(empty(speed, threads)), block(mesh::box({0.2, 0.2, 0.1}, cells)) {
        rubber = world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.5, .damping = 20});
        floor = world.add_collider(Plane{});
        low = add({0, 0, 0.051});
        high = add({0.01, 0, 0.153});
        beside = add({1, 0, 0.051});
    }
    static World empty(Real speed, int threads) {
        return tuned_world({.threads = threads, .sleep = speed < 0, .sleep_time = sleep_time},
                           {.sleep_speed = std::max<Real>(speed, 0)});
    }
    BodyHandle add(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
        return world.add_body(
            block, {.material = rubber, .position = position, .velocity = velocity, .contact_distance = 0.002});
    }
    std::vector<Vec3> copy(BodyHandle body) const {
        const auto x = world.positions(body);
        return {x.begin(), x.end()};
    }
    bool all_asleep() const { return world.report().asleep == world.bodies().size(); }
    /// Advances until all bodies sleep; the tower sways for a while. Returns false if they do not within eight seconds.
    bool settle() {
        for (int i = 0; i < 160 && !all_asleep(); ++i)
            if (!world.advance(0.05).ok()) return false;
        return all_asleep();
    }
};

Real distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real largest = 0;
    for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n] - b[n]).norm());
    return largest;
}

}  // namespace

TEST_CASE("a settled body rests bitwise still, near the place where it would have settled", "[scene]") {
    Tower tower, awake(0);
    REQUIRE(tower.settle());
    CHECK(tower.world.asleep(tower.low));
    const auto low = tower.copy(tower.low), high = tower.copy(tower.high);
    const WorldReport before = tower.world.report();
    REQUIRE(tower.world.advance(0.5).ok());
    const WorldReport after = tower.world.report();
    CHECK(distance(low, tower.copy(tower.low)) == 0);
    CHECK(distance(high, tower.copy(tower.high)) == 0);
    CHECK(after.energy.kinetic == 0);
    CHECK(after.steps > before.steps + 100);
    CHECK(after.contact_sum == before.contact_sum);  // contacts are not searched
    CHECK(after.momentum_error_share < 1e-12 * static_cast<Real>(after.steps));
    CHECK(after.energy_error_share < 0.05);

    REQUIRE(awake.world.advance(tower.world.time()).ok());
    CHECK(awake.world.report().asleep == 0);
    // A still body drifts by less than its speed limit times the time for which it is observed.
    CHECK(distance(high, awake.copy(awake.high)) < sleep_speed * sleep_time);
}

TEST_CASE("a body that falls on a tower wakes all of it, and only it", "[scene]") {
    Tower tower;
    REQUIRE(tower.settle());
    tower.add({0, 0.02, 0.26}, {0, 0, -0.5});
    bool woken = false, beside_rested = true, landed = false;
    for (int i = 0; i < 100; ++i) {
        REQUIRE(tower.world.advance(0.01).ok());
        landed |= !tower.world.contacts().empty() && tower.world.time() > 0.2;
        woken |= !tower.world.asleep(tower.low) && !tower.world.asleep(tower.high);
        beside_rested &= tower.world.asleep(tower.beside);
    }
    CHECK(landed);
    CHECK(woken);
    CHECK(beside_rested);
    CHECK(tower.world.report().worst_volume_ratio > 0.5);
}

TEST_CASE("removing the support, a load, an impulse or a change of the body wakes it", "[scene]") {
    Tower tower;
    REQUIRE(tower.settle());
    SECTION("the collider under it goes") {
        tower.world.remove(tower.floor);
        REQUIRE(tower.world.advance(0.1).ok());
        CHECK(mean_velocity(tower.world, tower.low, node_masses(tower.world, tower.low, tower.block, 500)).z() < -0.9);
    }
    SECTION("a load") {
        tower.world.set_loads(tower.beside, std::vector<Vec3>(tower.block.nodes.size(), Vec3(0, 0, 1)));
        CHECK_FALSE(tower.world.asleep(tower.beside));
        REQUIRE(tower.world.advance(0.1).ok());
        CHECK(mean_velocity(tower.world, tower.beside, node_masses(tower.world, tower.beside, tower.block, 500)).z() >
              0.1);
        CHECK(tower.world.asleep(tower.low));
    }
    SECTION("a kick to the low block carries the high one along") {
        tower.world.set_velocities(tower.low, std::vector<Vec3>(tower.block.nodes.size(), Vec3(0.3, 0, 0)));
        CHECK(tower.world.asleep(tower.high));
        REQUIRE(tower.world.advance(0.02).ok());
        CHECK_FALSE(tower.world.asleep(tower.high));
        CHECK(tower.world.asleep(tower.beside));
    }
    SECTION("wake") {
        tower.world.wake(tower.high);
        CHECK_FALSE(tower.world.asleep(tower.high));
        CHECK(tower.settle());
    }
    SECTION("gravity that turns") {
        tower.world.set_gravity({0, 0, 5});
        REQUIRE(tower.world.advance(0.1).ok());
        CHECK(mean_velocity(tower.world, tower.high, node_masses(tower.world, tower.high, tower.block, 500)).z() > 0.4);
    }
}

TEST_CASE("a collider that starts to move wakes the bodies on it, and bodies on a moving collider do not rest",
          "[scene]") {
    World world = Tower::empty(sleep_speed, 1);
    const auto rubber = world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.5, .damping = 20});
    // A box that stands for two seconds and then moves on.
    world.add_collider(Box{{1, 1, 0.1}},
                       {.motion = {.keys = {{.time = 0}, {.time = 2}, {.time = 4, .position = {0.4, 0, 0}}}}});
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    const auto block = world.add_body(mesh, {.material = rubber, .position = {0, 0, 0.101}, .contact_distance = 0.002});
    REQUIRE(world.advance(1.9).ok());
    REQUIRE(world.asleep(block));
    const Real start = world.center_of_mass(block).x();
    REQUIRE(world.advance(1.1).ok());
    CHECK_FALSE(world.asleep(block));
    CHECK(world.center_of_mass(block).x() - start == Approx(0.2).margin(0.01));  // carried along by friction
}

TEST_CASE("a body on a moving attachment does not rest, however slowly it moves", "[scene]") {
    Settings settings;
    settings.sleep = true;
    settings.sleep_time = sleep_time;
    World world(settings);
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto block =
        world.add_body(mesh, {.material = world.add_material({.young_modulus = 1e6, .density = 500, .damping = 50})});
    std::vector<Index> top;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z() > 0.049) top.push_back(static_cast<Index>(n));
    world.attach(block, top, {.velocity = {1e-6, 0, 0}});
    for (int i = 0; i < 50; ++i) {
        REQUIRE(world.advance(0.02).ok());
        REQUIRE_FALSE(world.asleep(block));
    }
}

// The engine's own limits (docs/methods/skipping.md 3.1)

TEST_CASE("with the default limits a settled body rests close to its final place", "[scene][long]") {
    Tower tower(own_limits), awake(0);
    REQUIRE(tower.settle());
    REQUIRE(awake.world.advance(tower.world.time() + 1).ok());
    const Real edge = 0.2 / 3;
    for (const auto body : {&Tower::low, &Tower::high, &Tower::beside})
        CHECK(distance(tower.copy(tower.*body), awake.copy(awake.*body)) < 5e-3 * edge);
}

namespace {

/// A block on a tilted plane; the tilt is a turn of gravity.
struct Slab {
    World world;
    BodyHandle block;

    explicit Slab(Real degrees, bool sleep = true) : world(settings(degrees, sleep)) {
        world.add_collider(Plane{});
        const auto rubber = world.add_material({.young_modulus = 1e6, .density = 500, .friction = 0.3, .damping = 0});
        block = world.add_body(mesh::box({0.2, 0.2, 0.1}, {3, 3, 2}),
                               {.material = rubber, .position = {0, 0, 0.052}, .contact_distance = 0.002});
    }
    static Settings settings(Real degrees, bool sleep = true) {
        const Real angle = degrees * std::numbers::pi / 180;
        Settings settings;
        settings.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
        settings.sleep = sleep;
        return settings;
    }
};

}  // namespace

TEST_CASE("a slab that should slide is never put to rest, one that has come to a stop is", "[scene][long]") {
    for (const Real degrees : {16.71, 16.75, 16.8, 17.0, 18.0, 20.0, 22.0}) {  // friction holds up to 16.699 degrees
        Slab slab(degrees), awake(degrees, false);
        for (int i = 0; i < 40; ++i) {
            REQUIRE(slab.world.advance(0.05).ok());
            REQUIRE(awake.world.advance(0.05).ok());
            CAPTURE(degrees, slab.world.time());
            REQUIRE_FALSE(slab.world.asleep(slab.block));
        }
        const Vec3 displacement = slab.world.center_of_mass(slab.block) - awake.world.center_of_mass(awake.block);
        CHECK(displacement == Vec3::Zero());
    }
    Slab slab(15);
    REQUIRE(slab.world.advance(3).ok());
    CHECK(slab.world.asleep(slab.block));
}

namespace {

/// A heavy body that sinks under its weight.
struct Sinking {
    World world;
    Mesh mesh;
    BodyHandle body;

    /// A cantilever with a first frequency of about 3 rad/s under a thousandth of gravity, or a block on a plane.
    Sinking(bool held, Real damping, bool sleep) : world(settings(held, sleep)) {
        mesh = held ? mesh::box({1, 0.05, 0.1}, {20, 1, 2}) : mesh::box({0.2, 0.2, 0.2}, {4, 4, 4});
        const auto soft = world.add_material({.young_modulus = held ? 1e6 : 5e4,
                                              .poisson_ratio = 0,
                                              .density = 1000,
                                              .friction = 0.5,
                                              .damping = damping});
        if (!held) world.add_collider(Plane{});
        body = world.add_body(
            mesh, {.material = soft, .position = {0, 0, held ? 0 : 0.1011}, .contact_distance = held ? 0 : 0.001});
        if (held) world.attach(body, nodes_at(0, -0.5));
    }
    static Settings settings(bool held, bool sleep) {
        Settings settings;
        if (held) settings.gravity.z() *= 1e-3;
        settings.sleep = sleep;
        return settings;
    }
    std::vector<Index> nodes_at(int axis, Real place) const {
        std::vector<Index> rows;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (std::abs(mesh.nodes[n][axis] - place) < 1e-9) rows.push_back(static_cast<Index>(n));
        return rows;
    }
    Real mean_height(const std::vector<Index>& rows) const {
        Real sum = 0;
        for (const Index n : rows) sum += world.positions(body)[static_cast<std::size_t>(n)].z();
        return sum / static_cast<Real>(rows.size());
    }
};

}  // namespace

TEST_CASE("a body that sinks or swings under its weight rests within half a percent of its deflection",
          "[scene][long]") {
    const bool held = GENERATE(true, false);
    const Real damping = held ? GENERATE(6.0, 2.0) : GENERATE(8.0, 30.0);  // 1/s
    CAPTURE(held, damping);
    Sinking sleepy(held, damping, true), awake(held, damping, false);
    while (!sleepy.world.asleep(sleepy.body) && sleepy.world.time() < 20) REQUIRE(sleepy.world.advance(0.1).ok());
    REQUIRE(sleepy.world.asleep(sleepy.body));
    REQUIRE(awake.world.advance(sleepy.world.time() + 3).ok());
    const auto deflection = [&](const Sinking& one) {
        const auto end = held ? one.nodes_at(0, 0.5) : one.nodes_at(2, 0.1);
        return held ? -one.mean_height(end) : 0.2 - (one.mean_height(end) - one.mean_height(one.nodes_at(2, -0.1)));
    };
    CAPTURE(sleepy.world.time(), deflection(awake));
    CHECK(deflection(sleepy) == Approx(deflection(awake)).epsilon(5e-3));
}

TEST_CASE("a block that begins to tip over is never put to rest", "[scene][long]") {
    for (const Real degrees : {14.2, 14.5, 15.5}) {  // a stiff block stands up to 14.04 degrees
        World world(Slab::settings(degrees));
        world.add_collider(Plane{});
        const auto stiff = world.add_material({.young_modulus = 1e7, .density = 500, .friction = 1, .damping = 0});
        const auto block = world.add_body(mesh::box({0.1, 0.1, 0.4}, {2, 2, 6}),
                                          {.material = stiff, .position = {0, 0, 0.2005}, .contact_distance = 0.001});
        for (int i = 0; i < 60 && world.center_of_mass(block).z() > 0.1; ++i) {
            REQUIRE(world.advance(0.05).ok());
            CAPTURE(degrees, world.time());
            REQUIRE_FALSE(world.asleep(block));
        }
        CHECK(world.center_of_mass(block).z() < 0.1);
    }
}

TEST_CASE("a body at constant speed never rests, be it on ice, rolling, carried, or driven by a motor",
          "[scene][long]") {
    constexpr Real speed = 1e-4;  // 2 to 7 times below the speed at which bodies move too far to count as still [m/s]
    enum What { on_ice, rolling, carried, by_motor };
    const auto motion = GENERATE(on_ice, rolling, carried, by_motor);
    CAPTURE(motion);
    World world;
    const auto material =
        world.add_material({.young_modulus = 1e6, .density = 500, .friction = motion == on_ice ? 0.0 : 0.5});
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    BodySettings settings{.material = material, .velocity = {speed, 0, 0}, .contact_distance = 0.002};
    BodyHandle body;
    if (motion == rolling) {
        settings.position = {0, 0, 0.1 + 0.001};
        settings.angular_velocity = {0, speed / 0.1, 0};
        settings.dynamics = BodyDynamics::rigid;
        body = world.add_body(Sphere{0.1}, settings);
    } else {
        settings.position = {0, 0, motion == on_ice ? 0.051 : 1};
        if (motion == by_motor) settings.dynamics = BodyDynamics::rigid;
        body = world.add_body(mesh, settings);
    }
    if (motion == on_ice || motion == rolling) world.add_collider(Plane{});
    if (motion == carried) {
        std::vector<Vec3> lift;
        for (const Real mass : node_masses(world, body, mesh, 500)) lift.push_back(-mass * world.settings().gravity);
        world.set_loads(body, lift);
    }
    if (motion == by_motor)
        Joints(world).add({.kind = JointKind::hinge,
                           .first = body,
                           .point = {0, 0, 1},
                           .axis = {0, 0, 1},
                           .motor = JointMotor{.speed = speed / 0.1, .strength = 10}});
    for (int i = 0; i < 40; ++i) {
        REQUIRE(world.advance(0.1).ok());
        REQUIRE_FALSE(world.asleep(body));
    }
    const Vec3 displacement = motion == by_motor ? Vec3(world.pose(body).rotation.z() * 0.1, 0, 0)
                                                 : Vec3(world.center_of_mass(body) - settings.position);
    CHECK(displacement.x() == Approx(4 * speed).epsilon(0.02));
}

TEST_CASE("if all bodies appear still, regions are solved to 1e-5, else to the tolerance, with the same bits",
          "[scene][long]") {
    Tower tower(own_limits), awake(0);
    std::vector<Real> error, error_awake;  // error of each call
    while (!tower.all_asleep() && tower.world.time() < 8) {
        const StepReport report = tower.world.advance(0.01), report_awake = awake.world.advance(0.01);
        REQUIRE(report.ok());
        REQUIRE(report_awake.ok());
        error.push_back(report.worst_error);
        error_awake.push_back(report_awake.worst_error);
        if (tower.world.time() < 0.05) CHECK(distance(tower.copy(tower.high), awake.copy(awake.high)) == 0);
    }
    REQUIRE(tower.all_asleep());
    // `still` is the number of calls within the last sleep_time.
    constexpr auto still = static_cast<std::ptrdiff_t>(sleep_time / 0.01) - 1;
    CHECK(*std::max_element(error.end() - still, error.end()) < 1e-5);
    CHECK(*std::max_element(error_awake.end() - still, error_awake.end()) > 1e-5);
    CHECK(tower.world.report().worst_error > 1e-4);
}

TEST_CASE("rest is the same on any number of threads", "[scene][long]") {
    const Real speed = GENERATE(sleep_speed, own_limits);
    std::vector<std::uint64_t> hash;
    for (const int threads : {1, 2, 3}) {
        Tower tower(speed, threads, {5, 5, 3});  // a step of smaller blocks would not use a second thread
        for (int i = 0; i < 40; ++i) REQUIRE(tower.world.advance(0.02).ok());
        REQUIRE(tower.world.report().inline_steps == 0);
        REQUIRE(tower.world.report().asleep > 0);
        hash.push_back(tower.world.state_hash());
    }
    CHECK(hash[1] == hash[0]);
    CHECK(hash[2] == hash[0]);
}

}  // namespace skerry::test::sleep_test
