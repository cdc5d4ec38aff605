// Springs and dampers in whole steps, against closed forms (docs/methods/springs.md).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/world/world_state.h"
#include "skerry/scene.h"
#include "skerry/spring.h"
#include "tests/support/message_of.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::springs_test {

namespace {

constexpr Real radius = 0.1;
const Real ball_mass = 1000 * 4 * std::numbers::pi / 3 * radius * radius * radius;  // density of water [kg]

Settings with_step(Real h, const Vec3& gravity = Vec3::Zero()) {
    Settings settings = accurate(gravity);
    settings.step_size = h;
    return settings;
}

/// A rigid ball, a rigid box or an implicit box at the origin, on a spring along x to the world.
struct Oscillator {
    World world;
    BodyHandle body;
    SpringHandle spring;
    Real mass;

    Oscillator(const Settings& settings, SpringSettings with, BodyDynamics dynamics = BodyDynamics::rigid,
               const Vec3& at = Vec3::Zero())
        : world(settings) {
        const auto material = world.add_material(lossless({.young_modulus = 1e7}));
        body = dynamics == BodyDynamics::rigid ? world.add_body(Sphere{radius}, {.material = material})
                                               : world.add_body(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}),
                                                                {.material = material, .dynamics = dynamics});
        mass = world.mass(body);
        with.first = {.body = body, .point = at};
        spring = Springs(world).add(with);
    }
    SpringState state() const { return Springs(const_cast<World&>(world)).state(spring); }
    Real x() const { return world.center_of_mass(body).x(); }
};

/// Frequency [rad/s] and decay rate [1/s] of the motion of an oscillator, from its passages through zero and from the
/// largest distances between them.
struct Vibration {
    Real frequency = 0, decay = 0;
};
Vibration vibration_of(Oscillator& oscillator, Real h, int periods) {
    std::vector<Real> passages, peaks;
    Real before = oscillator.x(), before_that = before;
    while (static_cast<int>(passages.size()) < 2 * periods + 1) {
        REQUIRE(oscillator.world.advance(h).ok());
        const Real x = oscillator.x();
        if ((before > 0) != (x > 0)) passages.push_back(oscillator.world.time() - h * x / (x - before));
        if (!passages.empty() && std::abs(before) > std::abs(before_that) && std::abs(before) >= std::abs(x)) {
            const Real curvature = before_that - 2 * before + x, slope = (x - before_that) / 2;
            peaks.push_back(std::abs(before - slope * slope / 2 / curvature));
        }
        before_that = before;
        before = x;
    }
    const Real time = passages.back() - passages.front();
    const Real between = static_cast<Real>(peaks.size() - 1) * time / (2 * periods);
    return {2 * std::numbers::pi * periods / time, std::log(peaks.front() / peaks.back()) / between};
}

/// Sum of the momenta of all bodies [kg m/s].
Vec3 momentum_of(World& world) {
    const Model& model = WorldAccess::state_of(world).model;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& of_body : model.rigid_bodies.momentum) sum += of_body;
    for (std::size_t n = 0; n < model.nodes.position.size(); ++n)
        if (!model.node_has_frame(n)) sum += model.nodes.mass[n] * model.nodes.velocity[n];
    return sum;
}

}  // namespace

TEST_CASE("a body on a spring and a damper has the frequency and the decay of the closed form",
          "[scene][springs][long]") {
    for (const BodyDynamics dynamics : {BodyDynamics::rigid, BodyDynamics::implicit_elastic}) {
        CAPTURE(static_cast<int>(dynamics));
        constexpr Real h = 3e-4, omega = 10, ratio = 0.05;
        Oscillator oscillator(with_step(h), {.second = {.point = {-1, 0, 0}}, .stiffness = 1}, dynamics);
        Springs springs(oscillator.world);
        springs.set_stiffness(oscillator.spring, omega * omega * oscillator.mass);
        oscillator.world.set_velocity(oscillator.body, {1, 0, 0}, Vec3::Zero());
        CHECK(vibration_of(oscillator, h, 5).frequency == Approx(omega).epsilon(1e-3));
        springs.set_damping(oscillator.spring, 2 * ratio * omega * oscillator.mass);
        const Vibration damped = vibration_of(oscillator, h, 5);
        CHECK(damped.frequency == Approx(omega * std::sqrt(1 - ratio * ratio)).epsilon(1e-3));
        CHECK(damped.decay == Approx(ratio * omega).epsilon(1e-3));
    }
}

TEST_CASE("springs conserve momentum between bodies of every kind", "[scene][springs]") {
    World world(accurate(Vec3::Zero()));
    const auto material = world.add_material({.young_modulus = 1e5});
    const Mesh mesh = mesh::box({0.2, 0.2, 0.2}, {2, 2, 2});
    std::vector<BodyHandle> bodies{world.add_body(Sphere{radius}, {.material = material, .velocity = {1, 2, 0}})};
    Real x = 0.5;
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        bodies.push_back(world.add_body(mesh, {.material = material, .position = {x, 0, 0}, .dynamics = dynamics}));
        x += 0.5;
    }
    for (std::size_t b = 1; b < bodies.size(); ++b)
        Springs(world).add({.first = {.body = bodies[b - 1], .point = {0.5 * static_cast<Real>(b) - 0.45, 0.05, 0.02}},
                            .second = {.body = bodies[b], .point = {0.5 * static_cast<Real>(b) - 0.05, -0.05, 0.03}},
                            .stiffness = 200,
                            .damping = 5,
                            .rest_length = 0.2});
    const Vec3 before = momentum_of(world);
    REQUIRE(world.advance(1).ok());
    CHECK((momentum_of(world) - before).norm() < 1e-13 * before.norm() * 10);
    for (const BodyHandle body : bodies) CHECK(world.velocity(body).velocity.norm() > 0.01);  // only the first had one
    const WorldReport report = world.report();
    CHECK(report.energy_error_share < 2e-3);
    CHECK(report.momentum_error_share < 1e-12);
    CHECK(report.dissipated > 0);
}

TEST_CASE("a stiff spring at the stable step gains no energy in 100,000 steps", "[scene][springs][long]") {
    for (const BodyDynamics dynamics : {BodyDynamics::rigid, BodyDynamics::explicit_elastic}) {
        CAPTURE(static_cast<int>(dynamics));
        for (const Real damping : {0.0, 1.0}) {
            CAPTURE(damping);
            Settings settings = accurate(Vec3::Zero());
            World world(settings);
            const auto material = world.add_material(lossless({.young_modulus = 1e4}));
            const BodyHandle body = dynamics == BodyDynamics::rigid
                                        ? world.add_body(Sphere{0.02}, {.material = material})
                                        : world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = material});
            // The damper acts at a right angle to the spring, so that it limits the step without damping this motion.
            Springs(world).add({.first = {.body = body}, .second = {.point = {-1, 0, 0}}, .stiffness = 1e6});
            if (damping > 0)
                Springs(world).add({.first = {.body = body}, .second = {.point = {0, -10, 0}}, .damping = 10});
            world.set_velocity(body, {1, 0, 0}, Vec3::Zero());
            const Real h = world.report().stable_step * 0.95;
            CHECK(h < 1.0 / 200);
            Real early = 0, late = 0;
            for (int step = 0; step < 100000; ++step) {
                REQUIRE(world.advance(h).ok());
                const Real x = std::abs(world.center_of_mass(body).x());
                (step < 50000 ? early : late) = std::max(step < 50000 ? early : late, x);
            }
            CHECK(early > 0);
            CHECK(late <= early * (1 + 1e-6));
        }
    }
}

TEST_CASE("the weight of a body on a spring with a damper stretches it by the closed form", "[scene][springs]") {
    const Real stiffness = 500;
    Oscillator hanging(with_step(5e-3, {0, 0, -standard_gravity}),
                       {.second = {.point = {0, 0, 1}}, .stiffness = stiffness, .damping = 200});
    REQUIRE(hanging.world.advance(8).ok());
    CHECK(hanging.state().length == Approx(1 + ball_mass * standard_gravity / stiffness).epsilon(1e-6));
    CHECK(hanging.state().force == Approx(ball_mass * standard_gravity).epsilon(1e-6));
    CHECK(std::abs(hanging.state().rate) < 1e-6);
    CHECK(hanging.state().energy == Approx(std::pow(ball_mass * standard_gravity, 2) / (2 * stiffness)).epsilon(1e-5));
    CHECK(hanging.world.report().energy_error_share < 1e-3);
}

TEST_CASE("a spring beside the centre of a rigid body turns it", "[scene][springs]") {
    // The strength makes the force constant: F = 2 N along y at the arm 0.1 m.
    constexpr Real h = 1e-4, strength = 2;
    Oscillator oscillator(
        with_step(h),
        {.second = {.point = {radius, 1000, 0}}, .stiffness = 1000, .rest_length = 0, .strength = strength},
        BodyDynamics::rigid, {radius, 0, 0});
    const int steps = 20;
    for (int step = 0; step < steps; ++step) REQUIRE(oscillator.world.advance(h).ok());
    const Model& model = WorldAccess::state_of(oscillator.world).model;
    const Vec3 impulse = model.rigid_bodies.momentum[0];
    CHECK(impulse.y() == Approx(strength * steps * h).epsilon(0.03));  // the first kick may be half as long
    CHECK(model.rigid_bodies.angular_momentum[0].z() == Approx(radius * impulse.y()).epsilon(1e-6));
    CHECK(oscillator.state().force == strength);
}

TEST_CASE("steps ten times shorter give the same motion of a damped spring", "[scene][springs]") {
    const auto end_of = [](Real h) {
        Oscillator oscillator(with_step(h, {0, 0, -standard_gravity}),
                              {.second = {.point = {-1, 0, 0.5}}, .stiffness = 300, .damping = 3}, BodyDynamics::rigid,
                              {-radius, 0, 0});
        REQUIRE(oscillator.world.advance(1).ok());
        return oscillator.world.center_of_mass(oscillator.body);
    };
    const Vec3 fine = end_of(1e-4);
    CHECK((end_of(1e-3) - fine).norm() < 3e-3);
    CHECK((end_of(5e-4) - fine).norm() < 0.6 * (end_of(1e-3) - fine).norm());
}

TEST_CASE("a ball that bounces on a one-sided spring gains little energy at the stable step", "[scene][springs]") {
    constexpr Real drop = 0.1;  // height of the ball above the free end of the spring [m]
    World world(accurate());
    const BodyHandle ball = world.add_body(Sphere{0.02}, {.material = world.add_material({})});
    Springs(world).add({.first = {.body = ball},
                        .second = {.point = {0, 0, -1 - drop}},
                        .stiffness = 1e6,
                        .rest_length = 1,
                        .only = SpringSide::compression});
    Real lowest = 0, highest = -drop;  // `highest`: after the first bounce
    for (Real t = 0, h = world.report().stable_step * 0.95; t < 3; t += h) {
        REQUIRE(world.advance(h).ok());
        lowest = std::min(lowest, world.center_of_mass(ball).z());
        if (lowest < -drop) highest = std::max(highest, world.center_of_mass(ball).z());
    }
    CHECK(std::abs(highest) < 0.5 * drop);  // if the bound ignored the kink, a bounce would triple the energy
}

TEST_CASE("a spring for tension only is slack below its rest length, and one for compression only above",
          "[scene][springs]") {
    for (const SpringSide side : {SpringSide::tension, SpringSide::compression}) {
        const Real towards = side == SpringSide::tension ? -1 : 1;
        Oscillator oscillator(with_step(1e-3), {.second = {.point = {-1, 0, 0}},
                                                .stiffness = 400,
                                                .damping = 2,
                                                .rest_length = 1 - 0.2 * towards,
                                                .only = side});
        oscillator.world.set_velocity(oscillator.body, {-towards, 0, 0}, Vec3::Zero());
        REQUIRE(oscillator.world.advance(0.1).ok());
        CHECK(oscillator.state().force == 0);
        CHECK(oscillator.state().energy == 0);
        CHECK(oscillator.state().rate == Approx(-towards).epsilon(1e-9));
        bool acted = false;
        for (int step = 0; step < 500; ++step) {
            REQUIRE(oscillator.world.advance(1e-3).ok());
            CHECK(oscillator.state().force * towards <= 0);
            acted |= oscillator.state().force != 0;
        }
        CHECK(acted);
        CHECK(oscillator.state().rate * towards > 0.5);  // it sprang back
        CHECK(oscillator.world.report().energy_error_share < 1e-3);
    }
}

TEST_CASE("many strong dampers on one body bring it to rest and never push it back", "[scene][springs]") {
    for (const BodyDynamics dynamics : {BodyDynamics::rigid, BodyDynamics::implicit_elastic}) {
        Oscillator oscillator(with_step(5e-3), {.second = {.point = {-10, 0, 0}}, .damping = 1e4}, dynamics);
        for (int k = 1; k < 8; ++k)
            Springs(oscillator.world)
                .add({.first = {.body = oscillator.body}, .second = {.point = {-10.0 - k, 0, 0}}, .damping = 1e4});
        oscillator.world.set_velocity(oscillator.body, {1, 0, 0}, Vec3::Zero());
        Real before = 1;
        for (int step = 0; step < 200; ++step) {
            REQUIRE(oscillator.world.advance(5e-3).ok());
            const Real speed = momentum_of(oscillator.world).x() / oscillator.mass;
            CHECK(std::abs(speed) <= 1);
            if (dynamics == BodyDynamics::rigid) {  // a body that deforms bounces
                CHECK(speed <= before + 1e-12);
                CHECK(speed > -1e-12);
            }
            before = speed;
        }
        CHECK(std::abs(before) < 1e-3);
    }
}

TEST_CASE("a rest length that changes over time does work, and the balance accounts for it", "[scene][springs]") {
    // A winch lifts the ball by half a metre.
    Oscillator winch(with_step(1e-3, {0, 0, -standard_gravity}), {.second = {.point = {0, 0, 2}},
                                                                  .stiffness = 2000,
                                                                  .damping = 40,
                                                                  .rest_length = TimeTable({{0.2, 2}, {1.2, 1.5}})});
    REQUIRE(winch.world.advance(4).ok());
    CHECK(winch.state().rest_length == Approx(1.5));
    CHECK(winch.world.center_of_mass(winch.body).z() ==
          Approx(0.5 - ball_mass * standard_gravity / 2000).epsilon(1e-5));
    CHECK(winch.world.report().energy_error_share < 1e-3);
}

TEST_CASE("the balance of energy accounts for springs and dampers with leapfrog, too", "[scene][springs]") {
    for (const BodyDynamics dynamics : {BodyDynamics::rigid, BodyDynamics::implicit_elastic})
        for (const Real damping : {0.0, 5.0}) {
            Settings settings = with_step(2e-3);
            settings.integrator = Integrator::leapfrog;
            Oscillator oscillator(
                settings, {.second = {.point = {1, 0, 0}}, .stiffness = 400, .damping = damping, .rest_length = 0.8},
                dynamics);
            REQUIRE(oscillator.world.advance(3).ok());
            CHECK(oscillator.state().energy > 0);
            INFO(name_of(dynamics) << ", damping " << damping);
            // The energy of leapfrog oscillates by the share (omega h)^2 / 4.
            const Real angle = 2e-3 * std::sqrt(400 / oscillator.mass);
            CHECK(oscillator.world.report().energy_error_share < angle * angle / 4);
        }
}

TEST_CASE("an anchor on a moving collider pulls a body, and the balance accounts for the work", "[scene][springs]") {
    World world(with_step(2e-4));
    const auto material = world.add_material({});
    const BodyHandle ball = world.add_body(Sphere{radius}, {.material = material});
    const ColliderHandle hook =
        world.add_collider(Sphere{0.05}, {.position = {1, 0, 0}, .motion = {.velocity = {0.5, 0, 0}}});
    const SpringHandle spring = Springs(world).add(
        {.first = {.body = ball}, .second = {.collider = hook, .point = {1, 0, 0}}, .stiffness = 400, .damping = 80});
    REQUIRE(world.advance(2).ok());
    CHECK(Springs(world).state(spring).second.point.x() == Approx(2));
    CHECK(Springs(world).state(spring).length == Approx(1).epsilon(1e-6));
    CHECK(momentum_of(world).x() == Approx(0.5 * ball_mass).epsilon(1e-6));
    CHECK(world.report().energy_error_share < 1e-3);
    world.remove(hook);
    CHECK_FALSE(Springs(world).alive(spring));
}

TEST_CASE("a limited spring drags a body to a point that moves", "[scene][springs]") {
    Oscillator mouse(with_step(2e-3), {.second = {}, .stiffness = 200, .damping = 40, .rest_length = 0, .strength = 5});
    for (int frame = 1; frame <= 60; ++frame) {
        Springs(mouse.world).set_second(mouse.spring, {.point = {0, 0.01 * frame, 0}});
        REQUIRE(mouse.world.advance(1.0 / 60).ok());
        CHECK(std::abs(mouse.state().force) <= 5);
    }
    REQUIRE(mouse.world.advance(8).ok());
    CHECK((mouse.world.center_of_mass(mouse.body) - Vec3(0, 0.6, 0)).norm() < 1e-4);
}

TEST_CASE("a body that rests on a spring sleeps until the spring changes", "[scene][springs]") {
    Settings settings;
    const auto sleeping = [&] {
        Oscillator hanging(settings, {.second = {.point = {0, 0, 1}},
                                      .stiffness = 500,
                                      .damping = 60,
                                      .rest_length = TimeTable({{0, 1}, {6, 1}, {6.5, 0.8}})});
        REQUIRE(hanging.world.advance(5).ok());
        REQUIRE(hanging.world.asleep(hanging.body));
        return hanging;
    };
    Oscillator driven = sleeping();
    const Real height = driven.world.center_of_mass(driven.body).z();
    REQUIRE(driven.world.advance(2.5).ok());
    CHECK(driven.world.center_of_mass(driven.body).z() == Approx(height + 0.2).epsilon(0.02));

    const auto wakes = [&](auto&& change) {
        Oscillator hanging = sleeping();
        change(hanging);
        CHECK_FALSE(hanging.world.asleep(hanging.body));
    };
    wakes([](Oscillator& o) { Springs(o.world).set_second(o.spring, {.point = {0, 0, 1.5}}); });
    wakes([](Oscillator& o) { Springs(o.world).set_rest_length(o.spring, 0.5); });
    wakes([](Oscillator& o) { Springs(o.world).set_stiffness(o.spring, 100); });
    wakes([](Oscillator& o) { Springs(o.world).remove(o.spring); });
    Oscillator same = sleeping();
    Springs(same.world).set_stiffness(same.spring, 500);
    CHECK(same.world.asleep(same.body));
}

TEST_CASE("a body on a slow winch does not fall asleep before the winch stops", "[scene][springs][sleep]") {
    Oscillator winch({}, {.second = {.point = {0, 0, 1}},
                          .stiffness = 500,
                          .damping = 60,
                          .rest_length = TimeTable({{0, 1}, {8, 1 - 1.6e-5}})});
    bool slept = false;
    winch.world.watch_steps([&](const StepReport&) { slept |= winch.world.asleep(winch.body); });
    REQUIRE(winch.world.advance(7.9).ok());
    CHECK_FALSE(slept);
    REQUIRE(winch.world.advance(2).ok());
    CHECK(slept);
}

TEST_CASE("springs continue with the same bits with more threads, as a clone and from a file", "[scene][springs]") {
    const auto simulate = [](Index threads) {
        Settings settings;
        settings.threads = threads;
        World world(settings);
        const auto material = world.add_material({.young_modulus = 1e5});
        const ColliderHandle floor = world.add_collider(Plane{{0, 0, 1}, {0, 0, -1}});
        BodyHandle before{};
        for (int k = 0; k < 3; ++k) {
            const BodyHandle body =
                world.add_body(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}),
                               {.material = material,
                                .position = {0.5 * k, 0, 0},
                                .dynamics = k == 1 ? BodyDynamics::implicit_elastic : BodyDynamics::explicit_elastic});
            Springs(world).add({.first = {.body = body, .point = {0.5 * k, 0, 0.1}},
                                .second = {.collider = floor, .point = {0.5 * k, 0.1, 1}},
                                .stiffness = 500,
                                .damping = 3,
                                .rest_length = TimeTable({{0, 1}, {0.3, 0.7}})});
            if (k > 0)
                Springs(world).add({.first = {.body = before, .point = {0.5 * k - 0.4, 0, 0}},
                                    .second = {.body = body, .point = {0.5 * k - 0.1, 0, 0}},
                                    .stiffness = 100,
                                    .damping = 1});
            before = body;
        }
        world.advance(0.2);
        return world;
    };
    check_same_bits(simulate, [](World& world) { world.advance(0.2); });
}

TEST_CASE("a spring limits the steps of a rigid body after loading as before", "[scene][springs]") {
    check_same_bits(
        [](Index threads) {
            Settings settings{.gravity = Vec3::Zero()};
            settings.threads = threads;
            Oscillator oscillator(settings, {.second = {.point = {1, 0, 0}}, .stiffness = 1e6, .rest_length = 0.99});
            const Real frequency = std::sqrt(1e6 / oscillator.mass);
            CHECK(oscillator.world.stable_step() <= 2 / frequency);
            REQUIRE(oscillator.world.advance(0.05).ok());
            return oscillator;
        },
        [](World& world) {
            const auto before = world.report().steps;
            CHECK(world.stable_step() < 0.01);
            REQUIRE(world.advance(0.05).ok());
            CHECK(world.report().steps > before + 5);
        });
}

TEST_CASE("a spring in the wrong place is refused by field", "[scene][springs]") {
    Oscillator oscillator(with_step(1e-3), {.stiffness = 1});
    Springs springs(oscillator.world);
    const Anchor on_ball{.body = oscillator.body};
    const std::uint64_t before = oscillator.world.state_hash();
    const auto refused = [&](const SpringSettings& settings, const char* field) {
        CHECK_THAT(message_of([&] { springs.add(settings); }), Catch::Contains("spring") && Catch::Contains(field));
    };
    refused({}, "first, second");
    refused({.first = on_ball}, "stiffness, damping");
    refused({.first = on_ball, .stiffness = -1}, "stiffness");
    refused({.first = on_ball, .damping = infinity}, "damping");
    refused({.first = on_ball, .rest_length = -0.1}, "rest_length");
    refused({.first = on_ball, .strength = 0}, "strength");
    refused({.first = on_ball, .rest_length = TimeTable(std::vector<TimeKey>{})}, "rest_length");
    CHECK_THAT(message_of([&] { springs.set_stiffness(oscillator.spring, -1); }), Catch::Contains("stiffness"));
    CHECK_THROWS_AS(oscillator.world.set_dynamics(oscillator.body, BodyDynamics::implicit_elastic), SceneError);
    CHECK(oscillator.world.state_hash() == before);
    Settings trapezoid = with_step(1e-3);
    trapezoid.theta = 0.5;
    CHECK_THAT(message_of([&] { Oscillator(trapezoid, {.stiffness = 1}, BodyDynamics::implicit_elastic); }),
               Catch::Contains("theta 0.5"));
    springs.remove(oscillator.spring);
    CHECK_FALSE(springs.alive(oscillator.spring));
    CHECK_THROWS_AS(springs.state(oscillator.spring), SceneError);
}

TEST_CASE("a scene file defines springs by points in the frames of their objects", "[scene][springs]") {
    const auto text = [](const std::string& springs) {
        return R"({"settings": {"gravity": [0, 0, 0]}, "materials": {"steel": {}}, "bodies": [{"name": "ball",
            "shape": {"sphere": {"radius": 0.1}}, "material": "steel", "dynamics": "rigid", "position": [1, 0, 0],
            "rotation": {"axis": [0, 0, 1], "degrees": 90}}],
            "colliders": [{"name": "hook", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 3, 0]}],
            "probes": [{"name": "pull", "quantity": "spring", "spring": "cord"}], "springs": [)" +
               springs + "]}";
    };
    Scene scene = load_scene_text(text(R"({"name": "cord", "first": {"body": "ball", "point": [0.1, 0, 0]},
        "second": {"collider": "hook", "point": [1, 0, 0]}, "stiffness": 50, "damping": 2, "strength": 9,
        "only": "tension", "rest_length": [[0, 1], [2, 3]]})"),
                                  ".");
    const std::vector<SpringHandle> all = Springs(scene.world).all();
    REQUIRE(all.size() == 1);
    const SpringState state = Springs(scene.world).state(all.front());
    CHECK((state.first.point - Vec3(1, 0.1, 0)).norm() < 1e-14);
    CHECK((state.second.point - Vec3(1, 3, 0)).norm() < 1e-14);
    CHECK(state.rest_length == 1);
    CHECK(state.energy == Approx(9 * (1.9 - 9.0 / 100)));
    CHECK(std::holds_alternative<SpringProbe>(scene.recorded.front().what));
    CHECK_THAT(
        message_of([&] { load_scene_text(text(R"({"name": "cord", "first": {"body": "bal"}, "second": {}})"), "."); }),
        Catch::Contains("springs[0]") && Catch::Contains("body") && Catch::Contains("ball"));
    CHECK_THAT(
        message_of([&] { load_scene_text(text(R"({"name": "line", "first": {"body": "ball"}, "second": {}})"), "."); }),
        Catch::Contains("probes[0].spring") && Catch::Contains("the name of a spring"));
    CHECK_THAT(message_of([&] {
                   load_scene_text(text(R"({"name": "cord", "first": {}, "second": {"collider": "hook"}})"), ".");
               }),
               Catch::Contains("springs[0]") && Catch::Contains("no body"));
}

TEST_CASE("a spring on an implicit body acts in every step, whatever implicit_step is", "[scene][springs]") {
    constexpr Real h = 2e-4, omega = 10;
    Settings settings = with_step(h);
    settings.implicit_step = 0.05;
    Oscillator oscillator(settings, {.second = {.point = {-1, 0, 0}}, .stiffness = 1}, BodyDynamics::implicit_elastic);
    Springs(oscillator.world).set_stiffness(oscillator.spring, omega * omega * oscillator.mass);
    oscillator.world.set_velocity(oscillator.body, {1, 0, 0}, Vec3::Zero());
    CHECK(vibration_of(oscillator, 0.01, 5).frequency == Approx(omega).epsilon(1e-3));
}

TEST_CASE("a lighter material of a body on a spring shortens the step", "[scene][springs]") {
    World world(accurate(Vec3::Zero()));
    const auto material = world.add_material({.density = 1000});
    const BodyHandle ball = world.add_body(Sphere{0.02}, {.material = material});
    Springs(world).add({.first = {.body = ball}, .second = {.point = {1, 0, 0}}, .stiffness = 1e6});
    const Real before = world.report().stable_step;
    world.set_material(material, {.density = 250});
    CHECK(world.report().stable_step == Approx(before / 2).epsilon(1e-9));
}

}  // namespace skerry::test::springs_test
