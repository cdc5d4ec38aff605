// Ties in whole steps, against closed forms (docs/methods/ties.md).
#include "skerry/tie.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "skerry/joint.h"
#include "skerry/scene.h"
#include "tests/support/message_of.h"
#include "tests/support/same_bits.h"
#include "tests/support/two_halves.h"
#include "tests/support/worlds.h"

namespace skerry::test::ties_test {

using namespace two_halves;

namespace {

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // angular: about the origin
};

Momenta momenta(const World& world, BodyHandle body, const Mesh& mesh, Real density = 1000) {
    const std::vector<Real> mass = node_masses(world, body, mesh, density);
    Momenta sum;
    for (std::size_t n = 0; n < mass.size(); ++n) {
        const Vec3 momentum = mass[n] * world.velocities(body)[n];
        sum.linear += momentum;
        sum.angular += world.positions(body)[n].cross(momentum);
    }
    return sum;
}

Momenta operator+(const Momenta& a, const Momenta& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}

}  // namespace

TEST_CASE("two tied halves conserve momentum and angular momentum", "[scene][ties]") {
    TwoHalves bar;
    bar.world.set_velocity(bar.left, {0.3, 0.2, -0.1}, {1, 2, 3});
    bar.world.set_velocity(bar.right, {-0.3, 0.1, 0.2}, {-2, 1, 4});
    const auto sum = [&] { return momenta(bar.world, bar.left, coarse) + momenta(bar.world, bar.right, fine); };
    const Momenta before = sum();
    REQUIRE(bar.world.advance(0.05).ok());
    const Momenta after = sum();
    CHECK((after.linear - before.linear).norm() < 1e-12);
    CHECK((after.angular - before.angular).norm() < 1e-12);
    const TieState state = Ties(bar.world).state(bar.tie);
    CHECK(state.error < 1e-9);
    CHECK(state.force.norm() > 0);
    CHECK(bar.world.report().energy_error_share < 1e-3);
    CHECK(bar.world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a weld to a rigid body across a gap conserves angular momentum", "[scene][ties]") {
    constexpr Real gap = 0.03;
    World world(without_gravity(1e-10));
    const Mesh box = mesh::box({side, 2 * side, 3 * side}, {1, 1, 1}), pad = mesh::box({side, side, side}, {2, 2, 2});
    const BodyHandle rigid =
        world.add_body(box, {.material = world.add_material(rubber), .dynamics = BodyDynamics::rigid});
    const BodyHandle soft = world.add_body(pad, {.material = world.add_material(rubber),
                                                 .position = {side + gap, 0, 0},
                                                 .dynamics = BodyDynamics::explicit_elastic});
    const TieHandle tie = Ties(world).add({.body = soft, .nodes = nodes_at(pad, -side / 2), .to_body = rigid});
    world.set_velocity(rigid, {0.1, 0.2, 0.3}, {3, -2, 1});
    const Real mass = 1000 * 6 * side * side * side;
    const Vec3 size(side, 2 * side, 3 * side);
    const Vec3 moments = mass / 12 * (Vec3::Constant(size.squaredNorm()) - size.cwiseAbs2());
    const auto sum = [&] {
        const Vec3 center = world.center_of_mass(rigid);
        const auto x = world.positions(rigid), v = world.velocities(rigid);
        Vec3 velocity = Vec3::Zero(), turning = Vec3::Zero();
        for (const Vec3& node_velocity : v) velocity += node_velocity / static_cast<Real>(v.size());
        Mat3 spread = Mat3::Zero(), axes;
        for (std::size_t n = 0; n < x.size(); ++n) {
            const Vec3 arm = x[n] - center;
            turning += arm.cross(v[n] - velocity);
            spread += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        }
        for (Index k = 0; k < 3; ++k) {  // the edges of the box
            const auto corner = [&](const Vec3& at) -> const Vec3& {
                for (std::size_t n = 0; n < x.size(); ++n)
                    if ((box.nodes[n] - at).norm() < 1e-9) return x[n];
                throw std::logic_error("no such corner");
            };
            const Vec3 low = -size / 2, high = low + size[k] * Vec3::Unit(k);
            axes.col(k) = (corner(high) - corner(low)).normalized();
        }
        const Vec3 spin = spread.inverse() * turning;
        const Momenta of_rigid{mass * velocity,
                               mass * center.cross(velocity) + axes * moments.asDiagonal() * axes.transpose() * spin};
        return of_rigid + momenta(world, soft, pad);
    };
    const Momenta before = sum();
    REQUIRE(world.advance(0.1).ok());
    const Momenta after = sum();
    CHECK(Ties(world).state(tie).force.norm() > 0.01);
    CHECK((after.linear - before.linear).norm() < 1e-12 * mass);
    CHECK((after.angular - before.angular).norm() < 1e-11 * before.angular.norm());
}

TEST_CASE("a tie stays exact for ten thousand steps", "[scene][ties][long]") {
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        Settings settings = without_gravity(1e-6);
        TwoHalves bar(settings, {}, dynamics);
        bar.world.set_velocity(bar.left, Vec3::Zero(), {0, 0, 3});
        const Real h = bar.world.stable_step();
        Real worst = 0, late = 0;
        for (int k = 0; k < 100; ++k) {
            REQUIRE(bar.world.advance(100 * h).ok());
            const Real error = Ties(bar.world).state(bar.tie).error;
            worst = std::max(worst, error);
            if (k >= 50) late = std::max(late, error);
        }
        CAPTURE(static_cast<int>(dynamics));
        // With frames, the error of a step is the change of their spin in the step times h^2. It is greatest at the
        // start, where the resting half is jerked into motion.
        CHECK(worst < (dynamics == BodyDynamics::explicit_elastic ? 1e-8 : 1e-6) * half);
        CHECK(late < (dynamics == BodyDynamics::explicit_elastic ? 1e-8 : 1e-7) * half);
        CHECK(bar.world.report().energy_error_share < 0.01);
    }
}

TEST_CASE("a node breaks off at its greatest force", "[scene][ties]") {
    constexpr Real limit = 2, rate = 10;  // [N], [N/s]
    Settings settings = without_gravity();
    World world(settings);
    const MaterialHandle material = world.add_material(rubber);
    const Mesh cube = mesh::box({side, side, side}, {1, 1, 1});
    const BodyHandle body = world.add_body(cube, {.material = material, .dynamics = BodyDynamics::implicit_elastic});
    Ties ties(world);
    const TieHandle tie = ties.add({.body = body, .nodes = {0}, .break_force = limit});
    Real most = 0;
    const Real h = 1e-4;
    while (!ties.state(tie).nodes[0].broken && world.time() < 1) {
        std::vector<Vec3> load(cube.nodes.size(), Vec3::Zero());
        load[0] = {rate * world.time(), 0, 0};
        world.set_loads(body, load);
        REQUIRE(world.advance(h).ok());
        most = std::max(most, ties.state(tie).force.norm());
    }
    const TieState broken = ties.state(tie);
    REQUIRE(broken.nodes[0].broken);
    CHECK(*broken.nodes[0].broken == Approx(limit / rate).epsilon(1e-3));
    CHECK(*broken.nodes[0].broken == world.time());
    CHECK(most == Approx(limit).epsilon(1e-3));
    REQUIRE(world.advance(h).ok());
    CHECK(ties.state(tie).force == Vec3::Zero());
    CHECK(world.center_of_mass(body).x() > 0);
}

TEST_CASE("a lower break force wakes a body and breaks it off", "[scene][ties]") {
    Settings settings = accurate();
    settings.sleep = true;
    settings.sleep_time = 0.05;
    World world(settings);
    const BodyHandle body = world.add_body(
        coarse, {.material = world.add_material({.young_modulus = 1e9}), .dynamics = BodyDynamics::implicit_elastic});
    Ties ties(world);
    const TieHandle tie = ties.add({.body = body, .nodes = nodes_at(coarse, -half / 2)});
    REQUIRE(world.advance(2).ok());
    REQUIRE(world.asleep(body));
    ties.set_break_force(tie, infinity);
    CHECK(world.asleep(body));  // an equal value changes nothing
    ties.set_break_force(tie, 0.01);
    CHECK_FALSE(world.asleep(body));
    REQUIRE(world.advance(0.05).ok());
    for (const TiedNode& node : ties.state(tie).nodes) CHECK(node.broken);
}

TEST_CASE("a tie follows a moving collider and keeps its bodies awake", "[scene][ties]") {
    Settings settings = accurate();
    settings.sleep = true;
    settings.sleep_time = 0.05;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        World world(settings);
        const MaterialHandle material = world.add_material({.young_modulus = 1e6, .damping = 50});
        const ColliderHandle box = world.add_collider(Box{{side, side, side}}, {.position = {0, 0, side + 0.02}});
        const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});
        const BodyHandle body = world.add_body(cube, {.material = material, .dynamics = dynamics});
        std::vector<Index> top;
        for (std::size_t n = 0; n < cube.nodes.size(); ++n)
            if (cube.nodes[n].z() > 0.049) top.push_back(static_cast<Index>(n));
        Ties ties(world);
        const TieHandle tie = ties.add({.body = body, .nodes = top, .to_collider = box});
        REQUIRE(world.advance(2).ok());
        CHECK(world.asleep(body));
        CHECK(ties.state(tie).force.z() == Approx(9.81).epsilon(1e-2));
        world.set_velocity(box, {0.2, 0, 0}, {0, 0, 1});
        REQUIRE(world.advance(1).ok());
        CHECK_FALSE(world.asleep(body));
        CHECK(ties.state(tie).error < 1e-7);
        CHECK(world.report().energy_error_share < 0.01);
        CHECK(world.report().momentum_error_share < 1e-9);
        const Vec3 expected = Vec3(0.2, 0, 0);
        CHECK((world.center_of_mass(body).head<2>() - expected.head<2>()).norm() < 2e-3);
    }
}

TEST_CASE("a pad on a jointed rigid pendulum keeps the period", "[scene][ties][long]") {
    constexpr Real length = 0.4, width = 0.04, pad_side = 0.04;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        Settings settings = accurate({0, 0, -standard_gravity}, 1e-8);
        World world(settings);
        const Mesh bar = mesh::box({width, width, length}, {1, 1, 2}),
                   pad = mesh::box({pad_side, pad_side, pad_side}, {2, 2, 2});
        const BodyHandle rigid = world.add_body(
            bar,
            {.material = world.add_material({}), .position = {0, 0, -length / 2}, .dynamics = BodyDynamics::rigid});
        const MaterialHandle stiff =
            world.add_material({.young_modulus = 2e6, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0});
        const BodyHandle soft =
            world.add_body(pad, {.material = dynamics == BodyDynamics::implicit_elastic
                                                 ? world.add_material({.young_modulus = 2e7, .poisson_ratio = 0.3})
                                                 : stiff,
                                 .position = {0, 0, -length - pad_side / 2},
                                 .dynamics = dynamics});
        Joints(world).add({.kind = JointKind::hinge, .first = rigid, .axis = {0, 1, 0}});
        std::vector<Index> top;
        for (std::size_t n = 0; n < pad.nodes.size(); ++n)
            if (pad.nodes[n].z() > 0.019) top.push_back(static_cast<Index>(n));
        const TieHandle tie = Ties(world).add({.body = soft, .nodes = top, .to_body = rigid});
        constexpr Real spin = 0.3;  // [rad/s] at the lowest point
        const auto turn = [&](BodyHandle body) {
            world.set_velocity(body, Vec3(0, spin, 0).cross(world.center_of_mass(body)), {0, spin, 0});
        };
        turn(rigid);
        turn(soft);
        const Real rod = 1000 * width * width * length, block = 1000 * pad_side * pad_side * pad_side;
        const Real at = length + pad_side / 2;
        const Real inertia =
            rod * (length * length / 3 + width * width / 12) + block * (at * at + pad_side * pad_side / 6);
        const Real weight = standard_gravity * (rod * length / 2 + block * at);
        const Real amplitude = 2 * std::asin(spin * std::sqrt(inertia / weight) / 2);
        const Real expected = 4 * std::sqrt(inertia / weight) * std::comp_ellint_1(std::sin(amplitude / 2));
        std::vector<Real> passages;
        constexpr Real h = 1e-3;
        Real before = world.center_of_mass(rigid).x();
        while (passages.size() < 3 && world.time() < 5) {
            REQUIRE(world.advance(h).ok());
            const Real now = world.center_of_mass(rigid).x();
            if (world.time() > 0.1 && (before > 0) != (now > 0))
                passages.push_back(world.time() - h * now / (now - before));
            before = now;
        }
        REQUIRE(passages.size() == 3);
        CAPTURE(static_cast<int>(dynamics));
        CHECK(passages[2] - passages[0] == Approx(expected).epsilon(1e-3));
        CHECK(Ties(world).state(tie).error < 1e-6);
        CHECK(world.report().momentum_error_share < 1e-9);
    }
}

TEST_CASE("a light soft block carries a body of ten thousand times its mass", "[scene][ties]") {
    for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::newton}) {
        Settings settings = accurate();
        settings.method = method;
        World world(settings);
        const Mesh small = mesh::box({0.05, 0.05, 0.05}, {1, 1, 1}), large = mesh::box({0.5, 0.5, 0.5}, {1, 1, 1});
        const BodyHandle soft =
            world.add_body(small, {.material = world.add_material({.young_modulus = 1e9, .poisson_ratio = 0.3}),
                                   .dynamics = BodyDynamics::implicit_elastic});
        const BodyHandle heavy = world.add_body(large, {.material = world.add_material({.density = 10000}),
                                                        .position = {0, 0, -0.275},
                                                        .dynamics = BodyDynamics::rigid});
        const auto at = [&](Real z) {
            std::vector<Index> nodes;
            for (std::size_t n = 0; n < small.nodes.size(); ++n)
                if (std::abs(small.nodes[n].z() - z) < 1e-9) nodes.push_back(static_cast<Index>(n));
            return nodes;
        };
        const TieHandle upper = Ties(world).add({.body = soft, .nodes = at(0.025)});
        const TieHandle lower = Ties(world).add({.body = soft, .nodes = at(-0.025), .to_body = heavy});
        REQUIRE(world.advance(2).ok());
        const Real weight = 10000 * 0.125 * standard_gravity;
        CAPTURE(static_cast<int>(method));
        CHECK(Ties(world).state(upper).force.z() == Approx(weight).epsilon(2e-3));
        CHECK(Ties(world).state(lower).force.z() == Approx(-weight).epsilon(2e-3));
        CHECK(Ties(world).state(lower).error < 1e-8);
    }
}

TEST_CASE("tied blocks slide with friction as one block", "[scene][ties]") {
    constexpr Real mu = 0.3, degrees = 30;
    World world(accurate(tilted_gravity(degrees)));
    const MaterialHandle material = world.add_material({.young_modulus = 1e6, .friction = mu, .damping = 100});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({side, side, side / 2}, {2, 2, 1}),
               above = mesh::box({side, side, side / 2}, {3, 3, 1});
    const BodyHandle lower = world.add_body(block, {.material = material,
                                                    .position = {0, 0, side / 4},
                                                    .contact_distance = 0,
                                                    .dynamics = BodyDynamics::implicit_elastic});
    const BodyHandle upper = world.add_body(
        above, {.material = material, .position = {0, 0, 3 * side / 4}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> bottom;
    for (std::size_t n = 0; n < above.nodes.size(); ++n)
        if (above.nodes[n].z() < 0) bottom.push_back(static_cast<Index>(n));
    const TieHandle tie = Ties(world).add({.body = upper, .nodes = bottom, .to_body = lower});
    REQUIRE(world.advance(0.2).ok());
    const Real before = world.center_of_mass(lower).x();
    REQUIRE(world.advance(0.2).ok());
    const Real angle = degrees * std::numbers::pi / 180;
    const Real rate = standard_gravity * (std::sin(angle) - mu * std::cos(angle));
    CHECK(world.center_of_mass(lower).x() - before == Approx(rate * (0.4 * 0.4 - 0.2 * 0.2) / 2).epsilon(0.02));
    CHECK(Ties(world).state(tie).error < 1e-7);
    CHECK(world.report().unconverged == 0);
}

TEST_CASE("a slide holds along the normal only", "[scene][ties]") {
    World world(accurate({2, 0, 5}));  // pulls away from the collider
    const MaterialHandle material = world.add_material({.young_modulus = 1e6});
    const ColliderHandle plane = world.add_collider(Plane{});
    const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});
    const BodyHandle body = world.add_body(
        cube, {.material = material, .position = {0, 0, side / 2}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> bottom;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n)
        if (cube.nodes[n].z() < -0.049) bottom.push_back(static_cast<Index>(n));
    const TieHandle tie =
        Ties(world).add({.kind = TieKind::slide, .body = body, .nodes = bottom, .to_collider = plane});
    REQUIRE(world.advance(0.5).ok());
    const TieState state = Ties(world).state(tie);
    CHECK(world.center_of_mass(body).x() == Approx(0.25).epsilon(1e-2));
    CHECK(state.error < 1e-9);
    CHECK(state.force.head<2>().norm() < 1e-9);
}

TEST_CASE("every solver method gives the same motion of tied bodies", "[scene][ties]") {
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        std::vector<Vec3> expected;
        for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
            Settings settings = without_gravity(1e-9);
            settings.method = method;
            settings.step_size = 1e-4;
            TwoHalves bar(settings, {}, dynamics);
            bar.world.set_velocity(bar.left, {0.1, 0, 0}, {1, 2, 3});
            REQUIRE(bar.world.advance(0.002).ok());
            const auto positions = bar.world.positions(bar.right);
            if (expected.empty()) expected.assign(positions.begin(), positions.end());
            Real worst = 0;
            for (std::size_t n = 0; n < expected.size(); ++n)
                worst = std::max(worst, (positions[n] - expected[n]).norm());
            CAPTURE(static_cast<int>(dynamics), name);
            CHECK(worst < 1e-9);
            CHECK(bar.world.velocity(bar.right).velocity.x() > 0.01);  // it starts at rest
            CHECK(bar.world.report().unconverged == 0);
        }
    }
}

TEST_CASE("a tied world goes on bitwise from files and with any number of threads", "[scene][ties]") {
    struct Course {
        World world;
    };
    check_same_bits(
        [](int threads) {
            Settings settings;
            settings.threads = threads;
            TwoHalves bar(settings, {.break_force = 10}, BodyDynamics::implicit_elastic);
            bar.world.add_collider(Plane{}, {.position = {0, 0, -0.1}});
            CHECK(bar.world.advance(0.12).ok());
            // Some of its nodes have broken off. Others carry forces, and break off later.
            const TieState state = Ties(bar.world).state(bar.tie);
            CHECK(std::ranges::any_of(state.nodes, [](const TiedNode& node) { return node.broken.has_value(); }));
            CHECK(state.force.norm() > 0);
            return Course{std::move(bar.world)};
        },
        [](World& world) { CHECK(world.advance(0.1).ok()); });
}

TEST_CASE("tied bodies do not collide until the last node has broken off", "[scene][ties]") {
    TwoHalves bar(without_gravity(), {.break_force = 0.5});
    CHECK_FALSE(bar.world.may_collide(bar.left, bar.right));
    bar.world.set_velocity(bar.right, {3, 0, 0});
    REQUIRE(bar.world.advance(0.2).ok());
    const TieState state = Ties(bar.world).state(bar.tie);
    for (const TiedNode& node : state.nodes) CHECK(node.broken);
    CHECK(bar.world.may_collide(bar.left, bar.right));
    CHECK(bar.world.center_of_mass(bar.right).x() > half);
    Ties(bar.world).remove(bar.tie);
    CHECK_FALSE(Ties(bar.world).alive(bar.tie));
    CHECK(bar.world.may_collide(bar.left, bar.right));

    TwoHalves removed;
    removed.world.remove(removed.left);
    CHECK_FALSE(Ties(removed.world).alive(removed.tie));
    REQUIRE(removed.world.advance(0.01).ok());
}

TEST_CASE("ties refuse wrong settings by name", "[scene][ties]") {
    TwoHalves bar;
    const BodyHandle rigid = bar.world.add_body(
        coarse, {.material = bar.world.add_material({}), .position = {0, 1, 0}, .dynamics = BodyDynamics::rigid});
    const auto message = [&](const TieSettings& settings) {
        return message_of([&] { Ties(bar.world).add(settings); });
    };
    using Catch::Contains;
    CHECK_THAT(message({.body = rigid, .nodes = {0}}), Contains("body") && Contains("which is rigid"));
    CHECK_THAT(message({.body = bar.left}), Contains("nodes") && Contains("no node"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0, 1, 0}}), Contains("node 0 twice"));
    CHECK_THAT(message({.body = bar.left, .nodes = {100000}}), Contains("node 100000"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0}, .to_body = bar.left}), Contains("itself"));
    CHECK_THAT(message({.kind = TieKind::slide, .body = bar.left, .nodes = {0}}), Contains("no surface"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0}, .break_force = 0}), Contains("break_force"));
    const ColliderHandle plane = bar.world.add_collider(Plane{}, {.position = {0, 0, -1}});
    bar.world.settle_start();
    const std::uint64_t before = bar.world.state_hash();
    for (const bool close_gap : {false, true})
        CHECK_THAT(message({.body = bar.left, .nodes = {0}, .to_collider = plane, .close_gap = close_gap}),
                   Contains("node 0, which is 0.95 m") && Contains("mean edge length"));
    CHECK(bar.world.state_hash() == before);
    CHECK(Ties(bar.world).all().size() == 1);
}

TEST_CASE("scenes tie a set, a box or nodes of a body to another object", "[scene][ties]") {
    const auto load = [](const std::string& tie) {
        return load_scene_text(R"({"name": "tied", "seconds": 1, "settings": {"gravity": [0, 0, -10]},
            "materials": {"steel": {"young_modulus": 1e9}},
            "bodies": [
                {"name": "pad", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "steel",
                 "dynamics": "implicit",
                 "sets": {"top": {"half_space": {"point": [0, 0, 0.05]}}}},
                {"name": "block", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "steel",
                 "dynamics": "rigid",
                 "position": [0, 0, -0.1]}],
            "colliders": [{"name": "roof", "shape": {"plane": {"normal": [0, 0, -1]}}, "position": [0, 0, 0.05]}],
            "ties": [)" + tie + "]}",
                               ".", {});
    };
    Scene scene = load(R"({"body": "pad", "set": "top", "to_collider": "roof"},
        {"body": "pad", "box": {"lower": [-1, -1, -0.05], "upper": [1, 1, -0.04]}, "to_body": "block",
         "break_force": 1e6})");
    REQUIRE(scene.world.advance(1).ok());
    const Ties ties(scene.world);
    REQUIRE(ties.all().size() == 2);
    CHECK(ties.state(ties.all()[0]).force.z() == Approx(20).epsilon(1e-3));
    CHECK(ties.state(ties.all()[1]).force.z() == Approx(-10).epsilon(1e-3));
    CHECK(ties.state(ties.all()[1]).break_force == 1e6);
    const auto message = [&](const std::string& tie) { return message_of([&] { load(tie); }); };
    using Catch::Contains;
    CHECK_THAT(message(R"({"body": "pad", "set": "side"})"), Contains("ties[0].set") && Contains("top"));
    CHECK_THAT(message(R"({"body": "pda", "set": "top"})"), Contains("ties[0].body") && Contains("pda"));
    CHECK_THAT(message(R"({"body": "pad", "set": "top", "break_force": -1})"), Contains("break_force"));
    CHECK_THAT(message(R"({"body": "block", "nodes": [0]})"), Contains("ties[0]") && Contains("which is rigid"));
}

}  // namespace skerry::test::ties_test
