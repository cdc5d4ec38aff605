// Sliders of scenes: the objects that they drive, their course, and refused entries.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/scene/scene_plan.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/slider.h"
#include "skerry/spring.h"
#include "systems/geometry/rotation.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::slider_test {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// A scene with an object of every kind that a slider can drive, and more keys at the top level.
std::string yard(const std::string& more) {
    return R"({"settings": {"gravity": [0, 0, 0], "sleep": false}, "materials": {"soft": {"E": 1e5, "rho": 1000}},
    "bodies": [
        {"name": "cube", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "soft",
         "sets": {"left": {"half_space": {"point": [-0.04, 0, 0], "normal": [-1, 0, 0]}},
                  "right": {"half_space": {"point": [0.04, 0, 0], "normal": [1, 0, 0]}}}, "pin": {"set": "left"}},
        {"name": "lever", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "soft",
         "position": [1, 0, 0], "dynamics": "rigid"},
        {"name": "sled", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "soft",
         "position": [2, 0, 0], "dynamics": "rigid"},
        {"name": "peg", "shape": {"sphere": {"radius": 0.1}}, "material": "soft", "position": [3, 0, 0]}],
    "colliders": [
        {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0, 3],
         "rotation": {"axis": [1, 0, 0], "degrees": 30}},
        {"name": "belt", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0, 5],
         "motion": {"velocity": [1, 0, 0]}}],
    "joints": [
        {"name": "hinge", "kind": "hinge", "first": "lever", "point": [1, 0, 0],
         "motor": {"position": 0.25, "strength": 9}},
        {"name": "rail", "kind": "slider", "first": "sled", "point": [2, 0, 0], "axis": [1, 0, 0],
         "motor": {"speed": 0, "strength": 9}},
        {"name": "knee", "kind": "hinge", "first": "peg", "point": [3, 0, 0]}],
    "cables": [{"name": "tendon", "points": [{"point": [0, 0, 1]}, {"body": "cube"}], "tension": [[0, 1], [1, 2]]}],
    "cavities": [
        {"name": "skin", "body": "cube", "pressure": 0},
        {"name": "bag", "body": "cube", "set": "right", "gas": {}, "volume": 1e-3},
        {"name": "bag_2", "body": "cube", "set": "right", "gas": {}, "volume": 1e-3},
        {"name": "syringe", "body": "cube", "set": "right", "liquid": {"bulk_modulus": 1e3}, "volume": 1e-3}],
    "pipes": [{"name": "valve", "first": "bag", "conductance": 0},
              {"name": "bridge", "first": "bag", "second": "bag_2", "conductance": 0}],
    "springs": [{"name": "band", "first": {"point": [0, 1, 0]}, "second": {"body": "cube"}, "stiffness": 1}],
    "loads": [{"name": "push", "kind": "force", "body": "cube", "nodes": [0], "force": [1, 0, 0]},
              {"name": "press", "kind": "acceleration", "body": "cube", "acceleration": [0, 0, 1], "scale": 2}],
    "fibres": [{"name": "muscle", "body": "cube", "direction": [1, 0, 0], "stiffness": 10}], "sliders": [)" +
           more + "]}";
}

Scene yard_with(const std::string& sliders) {
    return load_scene_text(yard(sliders), {});
}

std::string refusal_of(const std::string& slider) {
    return message_of([&] { (void)yard_with(slider); });
}

/// Sets a slider to a value that it reaches after 0.5 s, and requires that it has changed by half after 0.25 s.
void check_course(Scene& scene, const Slider& slider, const char* unit, Real start) {
    INFO(slider.name);
    CHECK(slider.unit == unit);
    CHECK(slider_value(scene.world, slider) == Approx(start).margin(1e-15));
    const Real now = slider_value(scene.world, slider), change = slider.fastest / 2;
    set_slider(scene.world, slider, now + change);
    CHECK(slider_value(scene.world, slider) == Approx(now).margin(1e-15));
    REQUIRE(scene.world.advance(0.25).ok());
    CHECK(slider_value(scene.world, slider) == Approx(now + change / 2).margin(1e-15));
    REQUIRE(scene.world.advance(0.5).ok());
    CHECK(slider_value(scene.world, slider) == Approx(now + change).margin(1e-15));
}

}  // namespace

TEST_CASE("a slider drives each kind of object from its present value to the new one at its rate", "[unit]") {
    Scene scene = yard_with(R"(
        {"name": "shift", "collider": "ball", "along": [0, 0, 2], "low": -1, "high": 1, "fastest": 0.4},
        {"name": "pin", "body": "cube", "along": [0, 1, 0], "low": -0.01, "high": 0.01},
        {"name": "angle", "joint": "hinge", "low": -0.5, "high": 1},
        {"name": "speed", "joint": "rail", "low": 0, "high": 0.2},
        {"name": "tension", "cable": "tendon", "low": 0, "high": 4},
        {"name": "inflow", "cavity": "bag", "low": 0, "high": 1e-9},
        {"name": "dose", "cavity": "syringe", "low": 1e-3, "high": 1.002e-3},
        {"name": "pressure", "cavity": "skin", "low": -5, "high": 5},
        {"name": "reservoir", "pipe": "valve", "low": 0, "high": 9},
        {"name": "length", "spring": "band", "low": 0.5, "high": 2},
        {"name": "force", "load": "push", "low": 0, "high": 2},
        {"name": "contraction", "fibres": "muscle", "low": 0, "high": 50})");
    const std::vector<std::pair<const char*, Real>> expected{{"m", 0},  {"m", 0},    {"rad", 0.25}, {"m/s", 0},
                                                             {"N", 1},  {"kg/s", 0}, {"m^3", 1e-3}, {"Pa", 0},
                                                             {"Pa", 0}, {"m", 1},    {"1", 1},      {"Pa", 0}};
    REQUIRE(scene.sliders.size() == expected.size());
    // The tension follows its own table until its slider is moved.
    check_course(scene, scene.sliders[4], "N", 1);
    for (std::size_t s = 0; s < expected.size(); ++s)
        if (s != 4) check_course(scene, scene.sliders[s], expected[s].first, expected[s].second);
    World& world = scene.world;
    const auto value = [&](std::size_t s) { return slider_value(world, scene.sliders[s]); };
    CHECK(world.pose(world.colliders()[0]).position.isApprox(Vec3(0, 0, 3.2), 1e-12));
    CHECK(Joints(world).state(Joints(world).find("hinge")).coordinate == Approx(value(2)).margin(1e-3));
    CHECK(Joints(world).state(Joints(world).find("rail")).speed == Approx(value(3)).epsilon(1e-3));
    CHECK(Cables(world).state(Cables(world).find("tendon")).tension[0] == Approx(value(4)));
    CHECK(Cavities(world).state(Cavities(world).find("skin")).pressure == Approx(value(7)));
    CHECK(Cavities(world).settings(Cavities(world).pipes()[0]).pressure.keys.back().value == value(8));
    CHECK(Springs(world).state(Springs(world).find("band")).rest_length == Approx(value(9)));
    CHECK(Loads(world).state(Loads(world).all()[0]).scale == Approx(value(10)));
    CHECK(Fibres(world).state(Fibres(world).all()[0]).tension == Approx(value(11)));
}

TEST_CASE("a slider turns an object about an axis of the world through the origin of the object", "[unit]") {
    Scene scene = yard_with(R"({"name": "turn", "collider": "ball", "about": [0, 0, 5], "low": -3, "high": 3})");
    check_course(scene, scene.sliders[0], "rad", 0);
    const MotionKey pose = scene.world.pose(scene.world.colliders()[0]);
    CHECK(pose.position == Vec3(0, 0, 3));
    const Mat3 expected = rotation_matrix(Vec3(0, 0, 3)) * rotation_matrix(Vec3(std::numbers::pi / 6, 0, 0));
    CHECK(rotation_matrix(pose.rotation).isApprox(expected, 1e-12));
}

TEST_CASE("a slider that turns an object by more than half a revolution passes all values between", "[unit]") {
    Scene scene = yard_with(R"({"name": "turn", "collider": "ball", "about": [0, 0, 1], "low": -3, "high": 3})");
    World& world = scene.world;
    const Slider& slider = scene.sliders[0];
    for (const Real end : {3.0, -3.0, 3.0}) {
        const Real start = slider_value(world, slider);
        set_slider(world, slider, end);
        const Real duration = std::abs(end - start) / slider.fastest;
        for (const Real share : {0.25, 0.5, 0.75, 1.0}) {
            REQUIRE(world.advance(duration / 4).ok());
            CHECK(slider_value(world, slider) == Approx(start + share * (end - start)).margin(1e-12));
        }
    }
}

TEST_CASE("one slider drives several objects, and a scene starts with the value of the slider", "[unit]") {
    Scene scene = yard_with(R"({"name": "both", "load": ["push", "press"], "low": 0, "high": 4},
        {"name": "lift", "collider": ["ball"], "along": [0, 0, 1], "low": -1, "high": 1, "value": 0.5},
        {"name": "inflate", "cavity": "skin", "low": 0, "high": 8, "value": 3})");
    Cavities cavities(scene.world);
    CHECK(cavities.state(cavities.find("skin")).pressure == 3);
    Loads loads(scene.world);
    set_slider(scene.world, scene.sliders[0], 3);
    REQUIRE(scene.world.advance(0.25).ok());  // half of the time that the first load needs from 1 to 3
    CHECK(loads.state(loads.find("push")).scale == Approx(2));
    CHECK(loads.state(loads.find("press")).scale == Approx(2.5));
    REQUIRE(scene.world.advance(0.5).ok());
    for (const LoadHandle load : loads.all()) CHECK(loads.state(load).scale == 3);
    CHECK(scene.world.pose(scene.world.colliders()[0]).position == Vec3(0, 0, 3.5));
    CHECK(slider_value(scene.world, scene.sliders[1]) == 0.5);
}

TEST_CASE("a slider that has its own value changes no bit of a run", "[unit]") {
    Scene without = yard_with(""), with = yard_with(R"({"name": "a", "cavity": "skin", "low": 0, "high": 8, "value": 0},
              {"name": "b", "joint": "hinge", "low": 0, "high": 1, "value": 0.25},
              {"name": "c", "spring": "band", "low": 0, "high": 2},
              {"name": "d", "collider": "ball", "along": [0, 0, 1], "low": -1, "high": 1, "value": 0})");
    for (Scene* scene : {&without, &with}) REQUIRE(scene->world.advance(0.05).ok());
    CHECK(without.world.state_hash() == with.world.state_hash());
}

TEST_CASE("a value out of bounds, and one for a removed object, are refused and change nothing", "[unit]") {
    Scene scene = yard_with(R"({"name": "lift", "collider": "ball", "along": [0, 0, 1], "low": -1, "high": 1},
        {"name": "force", "load": "push", "low": 0, "high": 2},
        {"name": "bend", "joint": "hinge", "low": 0, "high": 1})");
    const std::uint64_t before = scene.world.state_hash();
    CHECK_THAT(message_of([&] { set_slider(scene.world, scene.sliders[0], 1.5); }),
               Contains("slider 'lift'") && Contains("1.5") && Contains("-1 to 1 m"));
    CHECK_THAT(message_of([&] { set_slider(scene.world, scene.sliders[0], std::nan("")); }), Contains("nan"));
    CHECK(scene.world.state_hash() == before);
    Joints(scene.world).set_motor(Joints(scene.world).find("hinge"), {});
    CHECK_THAT(message_of([&] { set_slider(scene.world, scene.sliders[2], 0); }), Contains("a joint with a motor"));
    Loads(scene.world).remove(Loads(scene.world).all()[0]);
    CHECK_THAT(message_of([&] { set_slider(scene.world, scene.sliders[1], 0); }), Contains("load"));
}

TEST_CASE("a scene that is included with a name and a pose moves and renames its sliders", "[unit]") {
    const TemporaryFolder folder;
    folder.write("yard.json", yard(R"({"name": "lift", "collider": "ball", "along": [1, 0, 0], "low": -1, "high": 1},
        {"name": "valve", "pipe": "valve", "low": 0, "high": 9}, {"name": "push", "load": "push", "low": 0, "high": 2},
        {"name": "muscle", "fibres": "muscle", "low": 0, "high": 9})"));
    const Scene scene = load_scene(folder.write("two.json", R"({"include": [{"scene": "yard.json", "name": "east",
        "rotation": {"axis": [0, 0, 1], "degrees": 90}}]})"));
    REQUIRE(scene.sliders.size() == 4);
    CHECK(scene.sliders[0].name == "east/lift");
    CHECK(scene.sliders[0].along.isApprox(Vec3(0, 1, 0), 1e-14));
}

TEST_CASE("wrong sliders are refused with the file, the slider, the key and the reason", "[unit]") {
    CHECK_THAT(refusal_of(R"({"name": "a", "low": 0, "high": 1})"), Contains("slider \"a\"") && Contains("\"cable\""));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tend", "low": 0, "high": 9})"),
               Contains("sliders[0].cable: found \"tend\", expected one of \"tendon\" (did you mean \"tendon\"?)"));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "bal", "along": [1, 0, 0], "low": 0, "high": 9})"),
               StartsWith("scene: slider \"a\": sliders[0].collider: found \"bal\"") && Contains("\"ball\""));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "ball", "low": 0, "high": 1})"),
               Contains("neither \"along\" nor \"about\""));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "belt", "along": [1, 0, 0], "low": 0, "high": 1})"),
               Contains("motion"));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "ball", "along": [0, 0, 0], "low": 0, "high": 1})"),
               Contains("along") && Contains("length 0"));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "ball", "about": [0, 0, 1], "low": 0, "high": 4})"),
               Contains("half a revolution"));
    CHECK_THAT(refusal_of(R"({"name": "a", "collider": "ball", "about": [0, 0, 1], "low": -3.141592653589793,
                              "high": 3.14159})"),
               Contains("half a revolution"));
    CHECK(yard_with(R"({"name": "a", "collider": "ball", "about": [0, 0, 1], "low": -3.14159, "high": 3.14159})")
              .sliders.size() == 1);
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tendon", "along": [0, 0, 1], "low": 0, "high": 4})"),
               Contains("along"));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tendon", "pin": 1, "low": 0, "high": 4})"), Contains("pin"));
    CHECK_THAT(refusal_of(R"({"name": "a", "body": "cube", "pin": 1, "along": [0, 0, 1], "low": 0, "high": 1})"),
               Contains("1 pin,") && Contains("number 1"));
    CHECK_THAT(refusal_of(R"({"name": "a", "body": "sled", "along": [0, 0, 1], "low": 0, "high": 1})"),
               Contains("without \"pin\"") && Contains("add one"));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tendon", "low": 4, "high": 4})"),
               Contains("sliders[0].high") && Contains("more than \"low\""));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tendon", "low": 0, "high": 1.5})"),
               Contains("sliders[0].low") && Contains("2"));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": "tendon", "low": 0, "high": 3, "value": 4})"),
               Contains("sliders[0].value"));
    CHECK_THAT(refusal_of(R"({"name": "a", "pipe": "bridge", "low": 0, "high": 3})"), Contains("reservoir"));
    CHECK_THAT(refusal_of(R"({"name": "a", "joint": "knee", "low": 0, "high": 3})"), Contains("a joint with a motor"));
    CHECK_THAT(refusal_of(R"({"name": "a", "cable": [], "low": 0, "high": 3})"), Contains("empty list"));
    CHECK_THAT(refusal_of(R"({"name": "a", "joint": ["hinge", "rail"], "low": 0, "high": 3})"),
               Contains("rad") && Contains("m/s"));
    CHECK_THAT(refusal_of(R"({"name": "a", "load": "push", "low": 0, "high": 3},
                             {"name": "b", "load": "push", "low": 0, "high": 3})"),
               Contains("another slider"));
    CHECK_THAT(refusal_of(R"({"name": "a", "load": "push", "low": 0, "high": 3},
                             {"name": "a", "fibres": "muscle", "low": 0, "high": 3})"),
               Contains("different name"));
}

}  // namespace skerry::test::slider_test
