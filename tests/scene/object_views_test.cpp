// Names of joints, springs and cables, and settings of springs, cables, ties, loads, cavities and pipes, come back.
#include "skerry/object_view.h"

#include <catch2/catch.hpp>

#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/scene.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "tests/support/worlds.h"

namespace skerry::test::object_views_test {

namespace {

using Catch::Contains;

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
const TimeTable table({{0, 1}, {1, 2}});

bool same(const Anchor& a, const Anchor& b) {
    return a.body == b.body && a.collider == b.collider && (a.point - b.point).norm() < 1e-15;
}

/// An explicit body and a collider.
struct Joined {
    World world = World(accurate());
    BodyHandle body = world.add_body(
        cube, {.material = world.add_material({.young_modulus = 1e5}), .dynamics = BodyDynamics::explicit_elastic});
    ColliderHandle box = world.add_collider(Box{{0.1, 0.1, 0.1}}, {.position = {0, 0, 0.11}});

    std::vector<std::array<Index, 3>> top() const {
        return faces_where(world, body, [](const Vec3& x) { return x.z() > 0.03; });
    }
};

}  // namespace

TEST_CASE("settings of springs and cables come back", "[scene][views]") {
    Joined joined;
    Springs springs(joined.world);
    const SpringSettings spring{.first = {.body = joined.body, .point = {0.05, 0, 0}},
                                .second = {.collider = joined.box, .point = {0.05, 0, 0.1}},
                                .stiffness = 3,
                                .damping = 0.5,
                                .rest_length = table,
                                .only = SpringSide::compression,
                                .strength = 7};
    const SpringSettings back = springs.settings(springs.add(spring));
    CHECK(same(back.first, spring.first));
    CHECK(same(back.second, spring.second));
    CHECK(back.stiffness == 3);
    CHECK(back.damping == 0.5);
    CHECK(back.rest_length == spring.rest_length);
    CHECK(back.only == SpringSide::compression);
    CHECK(back.strength == 7);

    Cables cables(joined.world);
    for (const CableDrive& drive : {CableDrive{.tension = table}, {.length = table}, {.rate = table}}) {
        const CableSettings cable{
            .points = {{.point = {0, 0, -1}}, {.body = joined.body, .point = {0, 0, 0.02}}, {.point = {0, 1, 0}}},
            .drive = drive,
            .friction = 0.25};
        const CableSettings of_cable = cables.settings(cables.add(cable));
        REQUIRE(of_cable.points.size() == 3);
        for (std::size_t p = 0; p < 3; ++p) CHECK(same(of_cable.points[p], cable.points[p]));
        CHECK(of_cable.drive.tension == drive.tension);
        CHECK(of_cable.drive.length == drive.length);
        CHECK(of_cable.drive.rate == drive.rate);
        CHECK(of_cable.friction == 0.25);
    }
}

TEST_CASE("settings of ties and loads come back", "[scene][views]") {
    Joined joined;
    Ties ties(joined.world);
    const TieHandle tie = ties.add({.kind = TieKind::slide,
                                    .body = joined.body,
                                    .nodes = {26, 24},
                                    .to_collider = joined.box,
                                    .break_force = 5,
                                    .close_gap = true,
                                    .bodies_touch = true});
    const TieSettings of_tie = ties.settings(tie);
    CHECK(of_tie.kind == TieKind::slide);
    CHECK(of_tie.body == joined.body);
    CHECK(of_tie.nodes == std::vector<Index>{26, 24});
    CHECK(!of_tie.to_body);
    CHECK(of_tie.to_collider == joined.box);
    CHECK(of_tie.break_force == 5);
    CHECK(of_tie.close_gap);
    CHECK(of_tie.bodies_touch);
    CHECK_FALSE(ties.settings(ties.add({.body = joined.body, .nodes = {0}})).close_gap);

    Loads loads(joined.world);
    const LoadHandle traction = loads.add(TractionLoad{joined.body, joined.top(), {1, 2, 3}, table});
    const LoadHandle force = loads.add(ForceLoad{joined.body, {3, 1}, {4, 5, 6}, table});
    const LoadHandle second =
        loads.add(TractionLoad{joined.body, {joined.top().back()}, {1, 0, 0}, 1, LoadArea::present});
    const LoadHandle drag = loads.add(DragField{.rate = 2, .wind = {1, 0, 0}, .scale = table});
    const LoadHandle weight = loads.add(GravityScale{joined.body, table});
    loads.remove(traction);
    const auto of_second = std::get<TractionLoad>(loads.settings(second));
    CHECK(of_second.body == joined.body);
    CHECK(of_second.faces == std::vector{joined.top().back()});
    CHECK(of_second.traction == Vec3(1, 0, 0));
    CHECK(of_second.area == LoadArea::present);
    const auto of_force = std::get<ForceLoad>(loads.settings(force));
    CHECK(of_force.nodes == std::vector<Index>{3, 1});
    CHECK(of_force.force == Vec3(4, 5, 6));
    CHECK(of_force.scale == table);
    const auto of_drag = std::get<DragField>(loads.settings(drag));
    CHECK(!of_drag.body);
    CHECK(of_drag.rate == 2);
    CHECK(of_drag.wind == Vec3(1, 0, 0));
    CHECK(std::get<GravityScale>(loads.settings(weight)).body == joined.body);
}

TEST_CASE("a cavity that is added with the settings of another one has the same pressure and volume",
          "[scene][views]") {
    Joined joined;
    Cavities cavities(joined.world);
    const CavityHandle piston = cavities.add(
        {.body = joined.body,
         .faces = joined.top(),
         .filling =
             GasFilling{.pressure = 500, .exponent = 1.2, .ambient = 9e4, .density = 1.1, .inflow = TimeTable(1e-6)},
         .volume = 2e-3});
    const PipeHandle pipe = cavities.add(PipeSettings{.first = piston, .conductance = 1e-9, .pressure = table});
    const CavityHandle syringe = cavities.add({.body = joined.body,
                                               .faces = joined.top(),
                                               .filling = LiquidFilling{.bulk_modulus = 1e5, .ambient = 100},
                                               .volume = 1e-3});
    const CavityHandle pushed = cavities.add({.body = joined.body, .faces = joined.top(), .filling = TimeTable(40)});
    REQUIRE(joined.world.advance(0.01).ok());
    for (const CavityHandle cavity : {piston, syringe, pushed}) {
        const CavityState expected = cavities.state(cavity);
        const CavitySettings settings = cavities.settings(cavity);
        CHECK(settings.faces == joined.top());
        const CavityState found = cavities.state(cavities.add(settings));
        CHECK(found.law == expected.law);
        CHECK(found.pressure == Approx(expected.pressure).epsilon(1e-12));
        CHECK(found.volume == Approx(expected.volume).epsilon(1e-14));
        CHECK(found.mass == Approx(expected.mass).epsilon(1e-12));
    }
    const auto gas = std::get<GasFilling>(cavities.settings(piston).filling);
    CHECK(gas.exponent == 1.2);
    CHECK(gas.ambient == 9e4);
    CHECK(gas.density == 1.1);
    CHECK(gas.inflow == TimeTable(1e-6));
    CHECK(std::get<LiquidFilling>(cavities.settings(syringe).filling).bulk_modulus == 1e5);
    CHECK(std::get<TimeTable>(cavities.settings(pushed).filling) == TimeTable(40));
    const PipeSettings of_pipe = cavities.settings(pipe);
    CHECK(of_pipe.first == piston);
    CHECK(!of_pipe.second);
    CHECK(of_pipe.conductance == 1e-9);
    CHECK(of_pipe.pressure == table);
    cavities.remove(piston);
    CHECK_FALSE(cavities.alive(pipe));
}

TEST_CASE("objects are found by their names, also in a loaded world", "[scene][views]") {
    Joined joined;
    Springs springs(joined.world);
    const SpringSettings settings{.first = {.body = joined.body}, .second = {.point = {0, 0, 1}}, .stiffness = 1};
    const SpringHandle first = springs.add(settings), second = springs.add(settings);
    const std::uint64_t hash = joined.world.state_hash();
    CHECK(springs.name(second) == "spring_1");
    CHECK(springs.find("spring_1") == second);
    springs.set_name(second, "leash \xc3\xa4");
    CHECK(joined.world.state_hash() == hash);
    World copy = joined.world.clone(), loaded = World::from_bytes(joined.world.to_bytes());
    for (World* world : {&joined.world, &copy, &loaded}) {
        CHECK(Springs(*world).find("leash \xc3\xa4") == second);
        CHECK(Springs(*world).name(first) == "spring_0");
    }
    CHECK_THROWS_WITH(springs.find("leach"),
                      Contains("spring: name: found 'leach', expected one of 'spring_0', 'leash \xc3\xa4'"));
    springs.set_name(first, "leash \xc3\xa4");
    CHECK_THROWS_WITH(springs.find("leash \xc3\xa4"), Contains("which several objects have"));
    springs.remove(second);
    CHECK(springs.name(springs.add(settings)) == "spring_1");
    CHECK_THROWS_WITH(springs.set_name(second, "gone"), Contains("spring"));
    CHECK_THROWS_WITH(Joints(joined.world).find("hip"),
                      Contains("expected the name of a joint, but the world has none"));
}

TEST_CASE("a scene gives joining objects their names", "[scene][views]") {
    Scene scene = load_scene_text(R"({
        "materials": {"rubber": {"young_modulus": 1e5}},
        "bodies": [{"name": "a", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "rubber",
                    "dynamics": "rigid"}],
        "joints": [{"name": "hip", "kind": "ball", "first": "a", "point": [0, 0, 0]}],
        "springs": [{"first": {"body": "a"}, "second": {"point": [0, 0, 1]}, "stiffness": 1},
                    {"name": "leash", "first": {"body": "a"}, "second": {"point": [0, 0, 1]}, "stiffness": 2}],
        "cables": [{"name": "tendon", "points": [{"body": "a"}, {"point": [0, 0, 1]}], "tension": 1}]})",
                                  ".");
    CHECK(Joints(scene.world).alive(Joints(scene.world).find("hip")));
    CHECK(Springs(scene.world).settings(Springs(scene.world).find("leash")).stiffness == 2);
    CHECK(Springs(scene.world).settings(Springs(scene.world).find("spring_0")).stiffness == 1);
    CHECK(Cables(scene.world).name(Cables(scene.world).all()[0]) == "tendon");
}

}  // namespace skerry::test::object_views_test
