// Scenes that are included with a name and a pose.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <numbers>

#include "engine/scene/scene_plan.h"
#include "skerry/joint.h"
#include "skerry/scene.h"
#include "tests/unit/engine/scene_files.h"

namespace skerry::test::scene_place_test {

namespace {

/// An arm on a hinge whose drum mimics it, a block on a spring, a pushed block that hangs on a cable, and a collider.
const char* const machine = R"({"seconds": 9, "materials": {"steel": {"density": 2000}},
    "pairs": [{"materials": ["steel", "steel"], "friction": 0.2}],
    "bodies": [
        {"name": "arm", "mesh": {"box": {"size": [0.4, 0.1, 0.1], "cells": [2, 1, 1]}}, "material": "steel",
         "position": [0.2, 0, 0], "dynamics": "rigid"},
        {"name": "drum", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "steel",
         "position": [0, 0.5, 0], "dynamics": "rigid"},
        {"mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "steel",
         "repeat": {"count": [2, 1, 1], "spacing": [0.3, 0, 0], "jitter": 0.01}, "position": [0, -0.5, 0],
         "velocity": [0, 0, 1], "dynamics": "rigid"}],
    "colliders": [{"name": "wall", "shape": {"sphere": {"radius": 0.5}}, "position": [0, 0, -2], "material": "steel"}],
    "no_collision": [{"body": "arm", "to_body": "drum"}, {"body": "drum", "to_collider": "wall"}],
    "joints": [
        {"name": "hinge", "kind": "hinge", "first": "arm", "point": [0, 0, 0], "axis": [0, 1, 0], "coordinate": 0.1,
         "mimic": {"joint": "turn", "ratio": 0.5, "offset": 0.1}},
        {"name": "turn", "kind": "hinge", "first": "drum", "point": [0, 0.5, 0], "axis": [1, 0, 0],
         "motor": {"speed": 2, "strength": 1000}}],
    "cables": [{"points": [{"point": [0, -0.5, 1]}, {"body": "body_2_1"}], "tension": 5}],
    "loads": [{"kind": "force", "body": "body_2_0", "force": [0, 0, 3], "nodes": [0, 1]}],
    "springs": [{"first": {"point": [0, -0.5, 0.5]}, "second": {"body": "body_2_0"}, "stiffness": 100}],
    "probes": [{"name": "angle", "quantity": "joint", "joint": "hinge"}]})";

/// A scene that includes `machine.json` with a pose.
const char* const two = R"({"settings": {"gravity": [0, 0, 0]}, "include": [
    {"scene": "machine.json", "name": "left"},
    {"scene": "machine.json", "name": "right", "position": [10, 1, 2],
     "rotation": {"axis": [1, 2, 3], "degrees": 70}}]})";

}  // namespace

TEST_CASE("a scene that is included with a pose moves as the scene itself", "[unit]") {
    const TemporaryFolder folder;
    folder.write("machine.json", machine);
    Scene scene = load_scene(folder.write("two.json", two));
    CHECK(scene.seconds == SceneFile{}.seconds);
    CHECK(scene.materials == std::vector<std::string>{"left/steel", "right/steel"});
    REQUIRE(scene.recorded.size() == 2);
    CHECK(scene.recorded[1].name == "right_angle");
    World& world = scene.world;
    REQUIRE(world.advance(0.2).ok());
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    REQUIRE(bodies.size() == 8);
    const Mat3 turn = Eigen::AngleAxis<Real>(70 * std::numbers::pi / 180, Vec3(1, 2, 3).normalized()).matrix();
    for (std::size_t b = 0; b < 4; ++b) {
        INFO(world.name(bodies[b]));
        CHECK(world.name(bodies[b]).starts_with("left/"));
        CHECK(world.name(bodies[b + 4]).starts_with("right/"));
        for (std::size_t n = 0; n < world.positions(bodies[b]).size(); ++n) {
            const Vec3 expected = turn * world.positions(bodies[b])[n] + Vec3(10, 1, 2);
            CHECK((world.positions(bodies[b + 4])[n] - expected).norm() < 1e-6);
        }
    }
    CHECK(world.center_of_mass(bodies[2]).z() > 0.1);
    const JointHandle left = Joints(world).all()[0], right = Joints(world).all()[2];
    CHECK(Joints(world).state(left).coordinate == Approx(0.3).epsilon(1e-3));
    CHECK(Joints(world).mimic(right)->leader == Joints(world).all()[3]);
    for (const std::size_t copy : {0U, 1U}) {
        const BodyHandle arm = bodies[4 * copy], drum = bodies[4 * copy + 1];
        CHECK_FALSE(world.may_collide(arm, drum));
        CHECK(world.may_collide(arm, bodies[5 - 4 * copy]));
        CHECK_FALSE(world.may_collide(drum, world.colliders()[copy]));
        CHECK(world.may_collide(arm, world.colliders()[copy]));
    }
}

TEST_CASE("mistakes of scenes that are included with a name are refused", "[unit]") {
    const TemporaryFolder folder;
    folder.write("machine.json", machine);
    const auto refused = [&](const std::string& include, const char* text) {
        CHECK_THROWS_WITH(plan_scene(folder.write("top.json", R"({"include": [)" + include + "]}")),
                          Catch::Contains(text));
    };
    const std::string left = R"({"scene": "machine.json", "name": "left"})";
    refused(left + "," + left, "include[1].name: found \"left\", which another included scene has");
    refused(R"({"scene": "machine.json", "name": "a/b"})", "include[0].name: found \"a/b\", expected a name without /");
    refused(R"({"scene": "machine.json"})", "include[0]: found no key \"name\"");
    refused(R"({"scene": "nothing.json", "name": "left"})", "include[0].scene");
    folder.write("blow.json", scene_with(R"("loads": [{"kind": "acceleration", "acceleration": [1, 0, 0]}])"));
    refused(R"({"scene": "blow.json", "name": "left"})", "blow.json: loads[0].body: found no body");
    folder.write("roller.json",
                 body_with(R"("pin": {"box": {"lower": [-1, -1, -1], "upper": [1, 1, 0]}, "axes": ["z"]})"));
    refused(R"({"scene": "roller.json", "name": "left", "rotation": {"axis": [0, 0, 1], "degrees": 5}})",
            "bodies[0].pin.axes: found axes of the world");
    folder.write("round.json", R"({"include": {"scene": "round.json", "name": "again"}})");
    refused(R"({"scene": "round.json", "name": "left"})", "directly or through other files");
}

}  // namespace skerry::test::scene_place_test
