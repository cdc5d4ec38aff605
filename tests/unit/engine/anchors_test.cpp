// Anchors: points that are fixed to bodies, to colliders and to the world.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <vector>

#include "engine/world/query/place_anchor.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/load.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "tests/support/message_of.h"
#include "tests/support/worlds.h"

namespace skerry::test::anchors_test {

namespace {

/// Anchors of one world, stored as a table stores them.
struct Anchors {
    World& world;
    AnchorColumns columns;

    explicit Anchors(World& anchored_world) : world(anchored_world) {}

    std::size_t add(const Anchor& anchor) {
        const std::size_t row = columns.body.size();
        columns.body.resize(row + 1);
        columns.collider.resize(row + 1);
        columns.point.resize(row + 1);
        place_anchor(WorldAccess::state_of(world), anchor, "spring", "first").store(columns, row);
        return row;
    }
    Vec3 at(std::size_t row) const { return AnchorsBetweenSteps(WorldAccess::state_of(world)).at(columns, row).point; }
};

/// Force and moment about the origin of nodal forces.
struct Sum {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  // [N, N m]
};
Sum sum_of(const WorldState& state, std::span<const Vec3> force) {
    Sum sum;
    for (std::size_t n = 0; n < force.size(); ++n) {
        sum.force += force[n];
        sum.moment += state.model.nodes.position[n].cross(force[n]);
    }
    return sum;
}

constexpr Real rounding = 1e-14;

}  // namespace

TEST_CASE("an anchor is at the given point, and spreads a force without changing its sum or moment") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const Mesh mesh = mesh::box({0.4, 0.2, 0.2}, {4, 2, 2});
    const auto add = [&](BodyDynamics dynamics, Real x) {
        return world.add_body(
            mesh, {.material = material, .position = {x, 0, 0}, .rotation = {0.3, 0.2, -0.4}, .dynamics = dynamics});
    };
    const BodyHandle soft = add(BodyDynamics::explicit_elastic, 0), implicit = add(BodyDynamics::implicit_elastic, 2),
                     rigid = add(BodyDynamics::rigid, 4),
                     ball = world.add_body(Sphere{0.1}, {.material = material, .position = {6, 0, 0}});
    const ColliderHandle box = world.add_collider(Box{{1, 1, 1}}, {.position = {8, 0, 0}, .rotation = {0, 0.5, 0}});
    Anchors anchors(world);
    const std::vector<Anchor> given{
        {.body = soft, .point = {0.05, 0.02, 0.03}},  {.body = implicit, .point = {1.9, 0.01, -0.02}},
        {.body = rigid, .point = {4.02, 0.01, 0.03}}, {.body = rigid, .point = {5, 1, 1}},
        {.body = ball, .point = {6, 0.1, 0}},         {.body = soft, .point = {0.02, 0.01, 0.15}},
        {.collider = box, .point = {8.4, 0.3, -0.1}}, {.point = {1, 2, 3}},
    };
    for (const Anchor& anchor : given) anchors.add(anchor);
    const WorldState& state = WorldAccess::state_of(world);
    const AnchorsBetweenSteps now(state);
    const AnchorInputs inputs = now.of(anchors.columns);
    for (std::size_t row = 0; row < given.size(); ++row) {
        CAPTURE(row);
        CHECK((inputs.at(row) - given[row].point).norm() < rounding * 10);
        const Vec3 force(3, -2, 5);
        std::vector<Vec3> spread(state.model.nodes.position.size(), Vec3::Zero());
        inputs.add_force(row, force, spread);
        const Sum sum = sum_of(state, spread);
        const Vec3 expected = given[row].body ? force : Vec3(Vec3::Zero());
        CHECK((sum.force - expected).norm() < rounding * 100);
        CHECK((sum.moment - given[row].point.cross(expected)).norm() < rounding * 1000);
    }
}

TEST_CASE("an anchor follows the rotation of a rigid body and the pose of a collider") {
    World world{Settings{.gravity = Vec3::Zero()}};
    const auto material = world.add_material({});
    const BodyHandle ball = world.add_body(Sphere{0.1}, {.material = material, .angular_velocity = {0, 0, 2}});
    const ColliderHandle box =
        world.add_collider(Box{{1, 1, 1}}, {.position = {8, 0, 0}, .motion = {.velocity = {0, 1, 0}}});
    Anchors anchors(world);
    const std::size_t on_ball = anchors.add({.body = ball, .point = {0.1, 0, 0}}),
                      on_box = anchors.add({.collider = box, .point = {8, 0, 0.5}});
    world.advance(0.25);
    CHECK((anchors.at(on_ball) - 0.1 * Vec3(std::cos(0.5), std::sin(0.5), 0)).norm() < 1e-12);
    CHECK((anchors.at(on_box) - Vec3(8, 0.25, 0.5)).norm() < 1e-12);
    const AnchorsBetweenSteps now(WorldAccess::state_of(world));
    const AnchorInputs inputs = now.of(anchors.columns);
    CHECK((inputs.velocity(on_ball) - 0.2 * Vec3(-std::sin(0.5), std::cos(0.5), 0)).norm() < 1e-12);
    CHECK((inputs.velocity(on_box) - Vec3(0, 1, 0)).norm() < 1e-12);
}

TEST_CASE("an anchor that cannot be placed is refused with the reason") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const BodyHandle soft =
        world.add_body(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}), {.material = material, .name = "jelly"});
    const ColliderHandle floor = world.add_collider(Plane{});
    Anchors anchors(world);
    CHECK_THAT(message_of([&] {
                   anchors.add({.body = soft, .point = {0, 0, 0.5}});
               }),
               Catch::Contains("first.point") && Catch::Contains("0.4 m outside body 'jelly'") &&
                   Catch::Contains("mean edge length"));
    CHECK_THAT(message_of([&] { anchors.add({.body = soft, .collider = floor}); }),
               Catch::Contains("a body and a collider"));
    CHECK_THAT(message_of([&] { anchors.add({.point = {0, infinity, 0}}); }), Catch::Contains("first.point"));
    world.remove(soft);
    CHECK_THAT(message_of([&] { anchors.add({.body = soft}); }), Catch::Contains("spring"));
}

TEST_CASE("messages about joining objects name the bodies that they join") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const BodyHandle soft =
        world.add_body(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}), {.material = material, .name = "jelly"});
    world.add_collider(Plane{}, {.position = {0, 0, -1}, .name = "floor"});
    const ColliderHandle floor = world.colliders()[0];
    using Catch::Contains;

    Springs springs(world);
    const Anchor on_jelly{.body = soft}, on_floor{.collider = floor, .point = {0, 0, -1}};
    CHECK_THAT(message_of([&] { springs.add({.first = on_jelly, .second = on_floor, .stiffness = -1}); }),
               Contains("spring between body 'jelly' and collider 'floor': stiffness"));
    const SpringHandle spring = springs.add({.first = on_jelly, .second = {.point = {0, 0, 1}}, .stiffness = 1});
    CHECK_THAT(message_of([&] { springs.set_damping(spring, -1); }),
               Contains("spring between body 'jelly' and the world: damping"));

    Ties ties(world);
    CHECK_THAT(message_of([&] { ties.add({.body = soft, .to_collider = floor}); }),
               Contains("tie of body 'jelly' to collider 'floor': nodes"));
    const TieHandle tie = ties.add({.body = soft, .nodes = {0}});
    CHECK_THAT(message_of([&] { ties.set_break_force(tie, 0); }),
               Contains("tie of body 'jelly' to the world: break_force"));

    Cables cables(world);
    CHECK_THAT(message_of([&] {
                   cables.add({.points = {on_jelly, on_floor}, .drive = {}});
               }),
               Contains("cable from body 'jelly' to collider 'floor': drive"));
    const CableHandle cable = cables.add({.points = {on_jelly, on_floor}, .drive = {.tension = TimeTable(1)}});
    CHECK_THAT(message_of([&] { cables.set_drive(cable, {.length = TimeTable(-1)}); }),
               Contains("cable from body 'jelly' to collider 'floor': length"));

    Loads loads(world);
    CHECK_THAT(message_of([&] { loads.add(ForceLoad{.body = soft}); }), Contains("load on body 'jelly': nodes"));
    const LoadHandle load = loads.add(AccelerationField{});
    CHECK_THAT(message_of([&] {
                   loads.set_vector(load, {infinity, 0, 0});
               }),
               Contains("load on all bodies: acceleration"));

    Cavities cavities(world);
    const CavityHandle skin = cavities.add(CavitySettings{.body = soft, .filling = TimeTable(1)});
    CHECK_THAT(message_of([&] { cavities.set_pressure(skin, TimeTable(infinity)); }),
               Contains("cavity of body 'jelly': pressure"));
    CHECK_THAT(message_of([&] { cavities.add(PipeSettings{.first = skin}); }),
               Contains("pipe between the cavity of body 'jelly' and a reservoir: first"));
}

}  // namespace skerry::test::anchors_test
