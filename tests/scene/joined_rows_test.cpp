// Worlds in which joints, cables, ties and friction that depends on the direction act together, and forces that begin
// during a long step.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "skerry/cable.h"
#include "skerry/joint.h"
#include "skerry/spring.h"
#include "skerry/surface.h"
#include "skerry/tie.h"
#include "tests/support/worlds.h"

namespace skerry::test::joined_rows_test {

namespace {

constexpr Real side = 0.1;  // [m]
const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});

/// A body that slides on a plane with less friction across the axis x. Upon request a second body is tied to its top,
/// and two other bodies are tied together in the air.
struct Slider {
    World world;
    BodyHandle lower, upper;
    std::vector<Index> bottom;  // nodes of the lower face of each body

    Slider(SolverMethod method, BodyDynamics dynamics, bool carries, bool ties_elsewhere) : world(settings_of(method)) {
        const MaterialHandle material = world.add_material({.young_modulus = 1e6, .friction = 0.3, .damping = 20});
        world.add_collider(Plane{});
        const auto add = [&](const Vec3& place, BodyDynamics kind) {
            return world.add_body(cube,
                                  {.material = material, .position = place, .velocity = {1, 1, 0}, .dynamics = kind});
        };
        lower = add({0, 0, 0.051}, dynamics);
        for (std::size_t n = 0; n < cube.nodes.size(); ++n)
            if (cube.nodes[n].z() < -0.049) bottom.push_back(static_cast<Index>(n));
        SurfaceSets(world).add({.body = lower,
                                .nodes = bottom,
                                .surface = {.friction = 0.5},
                                .friction_across = 0.2,
                                .direction = Vec3::UnitX()});
        const auto tie_above = [&](BodyHandle below, const Vec3& place) {
            const BodyHandle above = add(place + Vec3(0, 0, side), BodyDynamics::explicit_elastic);
            Ties(world).add({.body = above, .nodes = bottom, .to_body = below});
            return above;
        };
        if (carries) upper = tie_above(lower, {0, 0, 0.051});
        if (ties_elsewhere) tie_above(add({0, 5, 3}, BodyDynamics::explicit_elastic), {0, 5, 3});
    }
    static Settings settings_of(SolverMethod method) {
        Settings settings = accurate({0, 0, -standard_gravity}, 1e-10);
        settings.method = method;
        settings.step_size = 2e-4;
        return settings;
    }
};

}  // namespace

TEST_CASE("a joint holds a body within the contact distance of a wall", "[scene]") {
    for (const Real gap : {1e-4, 1e-3, 5e-3})  // [m]
        for (const JointKind kind : {JointKind::slider, JointKind::fixed}) {
            CAPTURE(gap, static_cast<int>(kind));
            World world({.step_size = 5e-3, .sleep = false});
            const BodyHandle block = world.add_body(
                cube, {.material = world.add_material({}), .contact_distance = 0.01, .dynamics = BodyDynamics::rigid});
            world.add_collider(Plane{.normal = {1, 0, 0}, .point = {-side / 2 - gap, 0, 0}}, {.friction = 0});
            Joints(world).add({.kind = kind, .first = block, .axis = {0, 0, 1}});
            REQUIRE(world.advance(0.05).ok());
            CHECK(world.report().unconverged == 0);
            CHECK(world.contacts().size() == 9);
            for (const Contact& contact : world.contacts()) CHECK(contact.impulse.norm() < 1e-12);
            CHECK(std::abs(world.center_of_mass(block).x()) < 1e-12);
        }
}

TEST_CASE("a joint whose point is far from a small body holds it", "[scene]") {
    constexpr Real radius = 0.02, density = 1000, distance = 1;  // [m], [kg/m^3]
    for (const JointKind kind : {JointKind::slider, JointKind::fixed, JointKind::hinge}) {
        CAPTURE(static_cast<int>(kind));
        World world({.gravity = {0, 0, -standard_gravity}, .tolerance = 1e-9, .sleep = false});
        const MaterialHandle material = world.add_material({.density = density});
        const BodyHandle ball = world.add_body(
            Sphere{radius}, {.material = material, .position = {distance, 0, 0}, .dynamics = BodyDynamics::rigid});
        Joints joints(world);
        const JointHandle joint = joints.add({.kind = kind, .first = ball, .axis = {1, 0, 0}});
        REQUIRE(world.advance(0.3).ok());
        CHECK(world.report().unconverged == 0);
        CHECK((world.center_of_mass(ball) - Vec3(distance, 0, 0)).norm() < 1e-8);
        const JointState state = joints.state(joint);
        const Real weight = 4 * std::numbers::pi / 3 * radius * radius * radius * density * standard_gravity;  // [N]
        CHECK((state.force - Vec3(0, 0, weight)).norm() < 1e-6 * weight);
        CHECK((state.moment - Vec3(0, -weight * distance, 0)).norm() < 1e-6 * weight * distance);
    }
}

TEST_CASE("ties hold bodies whose edges touch", "[scene][ties]") {
    const auto dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid);
    World world({.step_size = 2e-4, .sleep = false});
    const MaterialHandle material = world.add_material({.young_modulus = 1e6, .damping = 20});
    const auto add = [&](const Vec3& place, BodyDynamics kind) {
        return world.add_body(cube, {.material = material, .position = place, .dynamics = kind});
    };
    const BodyHandle lower = add({0, 0, 0}, dynamics), upper = add({0, 0, side}, BodyDynamics::explicit_elastic),
                     beside = add({-side, 0, side}, BodyDynamics::explicit_elastic);
    std::vector<Index> bottom, right;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n) {
        if (cube.nodes[n].z() < -0.049) bottom.push_back(static_cast<Index>(n));
        if (cube.nodes[n].x() > 0.049) right.push_back(static_cast<Index>(n));
    }
    Ties ties(world);
    const std::array all{ties.add({.body = upper, .nodes = bottom, .to_body = lower}),
                         ties.add({.body = beside, .nodes = right, .to_body = upper})};
    REQUIRE(world.advance(0.01).ok());
    CHECK(!world.contacts().empty());  // of the lower body with the one beside it
    CHECK(world.report().unconverged == 0);
    for (const TieHandle tie : all) {
        CHECK(ties.state(tie).error < 1e-12);
        CHECK(ties.state(tie).largest_force < 1e-4);  // the weight of a body is 10 N
    }
}

TEST_CASE("ties do not change directional friction elsewhere", "[scene][ties]") {
    Slider alone(SolverMethod::automatic, BodyDynamics::explicit_elastic, false, false);
    Slider with_ties(SolverMethod::automatic, BodyDynamics::explicit_elastic, false, true);
    REQUIRE(alone.world.advance(0.1).ok());
    REQUIRE(with_ties.world.advance(0.1).ok());
    CHECK(with_ties.world.report().unconverged == 0);
    CHECK((alone.world.center_of_mass(alone.lower) - with_ties.world.center_of_mass(with_ties.lower)).norm() < 1e-10);
    const Vec3 velocity = alone.world.velocity(alone.lower).velocity;
    CHECK(velocity.y() > velocity.x() + 0.1);  // friction across the direction is smaller
}

TEST_CASE("every solver method gives the same motion with each kind of row", "[scene][ties]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::rigid}) {
        std::vector<Vec3> expected;
        for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
            CAPTURE(static_cast<int>(dynamics), name);
            Slider slider(method, dynamics, true, false);
            World& world = slider.world;
            const MaterialHandle material = world.add_material({});
            const BodyHandle pendulum =
                world.add_body(cube, {.material = material, .position = {2, 0, 2}, .dynamics = BodyDynamics::rigid});
            const BodyHandle lamp =
                world.add_body(cube, {.material = material, .position = {4, 0, 2}, .dynamics = BodyDynamics::rigid});
            Joints(world).add({.first = pendulum, .point = {2.1, 0, 2}});
            Cables(world).add(
                {.points = {{.point = {4.1, 0, 3}}, {.body = lamp, .point = {4, 0, 2.05}}}, .drive = {.length = 0.95}});
            const BodyHandle top = world.add_body(
                cube, {.material = material, .position = {0, 0, 0.051 + 2 * side}, .velocity = {1, 1, 0}});
            Ties(world).add({.kind = TieKind::ball, .body = top, .nodes = slider.bottom, .to_body = slider.upper});
            REQUIRE(world.advance(0.02).ok());
            CHECK(world.report().unconverged == 0);
            std::vector<Vec3> now;
            for (const BodyHandle body : {slider.lower, slider.upper, top, pendulum, lamp})
                now.push_back(world.center_of_mass(body));
            if (expected.empty()) expected = now;
            for (std::size_t b = 0; b < now.size(); ++b) CHECK((now[b] - expected[b]).norm() < 1e-8);
        }
    }
}

TEST_CASE("a tie that has broken off everywhere no longer leads or limits its body", "[scene][ties]") {
    Settings settings = accurate();
    settings.sleep = true;
    settings.sleep_time = 0.05;
    World world(settings);
    world.add_collider(Plane{});
    const MaterialHandle material = world.add_material({.young_modulus = 1e6, .damping = 50});
    const BodyHandle body = world.add_body(cube, {.material = material, .position = {0, 0, 0.051}});
    const BodyHandle other = world.add_body(cube, {.material = material,
                                                   .position = {0.14, 0, 0.11},
                                                   .velocity = {0, 0, 8},
                                                   .angular_velocity = {0, 0, 50},
                                                   .dynamics = BodyDynamics::rigid});
    const ColliderHandle box = world.add_collider(Box{{side, side, side}}, {.position = {0, 0, 0.18}});
    const auto corner = static_cast<Index>(
        std::ranges::find_if(cube.nodes, [](const Vec3& x) { return x.minCoeff() > 0.049; }) - cube.nodes.begin());
    Ties ties(world);
    const TieHandle to_box = ties.add({.body = body, .nodes = {corner}, .to_collider = box, .break_force = 0.01});
    const TieHandle to_other = ties.add({.body = body, .nodes = {corner}, .to_body = other, .break_force = 0.01});
    world.set_velocity(box, {0, 0, 1});
    REQUIRE(world.advance(0.01).ok());
    REQUIRE(ties.state(to_box).nodes[0].broken);
    REQUIRE(ties.state(to_other).nodes[0].broken);
    REQUIRE(world.advance(0.7).ok());
    CHECK(world.asleep(body));         // although the collider moves on
    CHECK_FALSE(world.asleep(other));  // which still flies
}

TEST_CASE("a force that begins during a long step does not cut it short", "[scene][implicit]") {
    constexpr Real rest = 0.05, speed = 1;  // slack of the spring or cable [m], speed of the body [m/s]
    enum class Force { spring, cable };
    for (const Force force : {Force::spring, Force::cable}) {
        std::vector<Vec3> place;
        for (const Real implicit_step : {0.0, 0.01}) {
            Settings settings = accurate(Vec3::Zero(), 1e-10);
            settings.step_size = 5e-4;
            settings.implicit_step = implicit_step;
            World world(settings);
            const MaterialHandle material = world.add_material({.young_modulus = 1e6});
            const BodyHandle body = world.add_body(
                cube, {.material = material, .velocity = {speed, 0, 0}, .dynamics = BodyDynamics::implicit_elastic});
            world.add_body(cube, {.material = material, .position = {0, 5, 0}});
            const Anchor first{.point = {-0.5, 0, 0}}, second{.body = body, .point = {0, 0, 0}};
            if (force == Force::spring)
                Springs(world).add({.first = first,
                                    .second = second,
                                    .stiffness = 200,
                                    .rest_length = TimeTable(0.5 + rest),
                                    .only = SpringSide::tension});
            else
                Cables(world).add({.points = {first, second}, .drive = {.length = 0.5 + rest}});
            REQUIRE(world.advance(0.137).ok());
            place.push_back(world.center_of_mass(body));
        }
        CAPTURE(static_cast<int>(force), place[0].transpose(), place[1].transpose());
        CHECK((place[1] - place[0]).norm() < 0.05 * rest);  // the force may begin one long step late
    }
}

}  // namespace skerry::test::joined_rows_test
