// Loads and force fields in scene files.
#include <catch2/catch.hpp>

#include "engine/scene/scene_plan.h"
#include "skerry/load.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::scene_loads_test {

using Catch::Matchers::Contains;

namespace {

/// Plans a scene with a unit cube of 2 x 2 x 2 cells, centred at the origin, and the given loads.
ScenePlan plan_with(const std::string& loads) {
    const TemporaryFolder folder;
    return plan_scene(folder.write("scene.json", R"({"materials": {"soft": {"rho": 1000}},
        "bodies": [{"name": "cube", "material": "soft", "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
                    "sets": {"top": {"half_space": {"point": [0, 0, 0.4]}}}}], "loads": [)" +
                                                     loads + "]}"));
}

std::string refusal_of(const std::string& loads) {
    return message_of([&] { build_scene(plan_with(loads)); });
}

}  // namespace

TEST_CASE("loads of a scene act on the parts and bodies that it names", "[unit]") {
    Scene scene = build_scene(plan_with(
        R"({"kind": "force", "body": "cube", "nodes": [3, 5], "force": [1, 2, 3], "scale": [[0, 2], [1, 0]]},
           {"kind": "traction", "body": "cube", "set": "top", "traction": [0, 0, 10], "area": "present"},
           {"kind": "acceleration", "acceleration": [1, 0, 0], "scale": 0.5},
           {"kind": "gravity", "scale": 0.25, "body": "cube"},
           {"kind": "drag", "rate": 2, "wind": [0, 1, 0]})"));
    Loads loads(scene.world);
    const std::vector<LoadHandle> all = loads.all();
    REQUIRE(all.size() == 5);
    CHECK(loads.state(all[0]).force.isApprox(Vec3(2, 4, 6), 1e-14));
    CHECK(loads.state(all[1]).force.isApprox(Vec3(0, 0, 10), 1e-14));
    CHECK(loads.state(all[2]).force.isApprox(Vec3(500, 0, 0), 1e-14));
    CHECK(!loads.state(all[2]).body);
    CHECK(loads.state(all[3]).force.isApprox(Vec3(0, 0, 0.75 * 9.81 * 1000), 1e-14));
    CHECK(loads.state(all[3]).body == scene.world.bodies()[0]);
    CHECK(loads.state(all[4]).force.isApprox(Vec3(0, 2000, 0), 1e-14));
    REQUIRE(scene.world.advance(0.01).ok());
    const BodyHandle cube = scene.world.bodies()[0];
    std::vector<Vec3> doubled;
    for (const Vec3& x : scene.world.positions(cube)) doubled.push_back(2 * x);
    scene.world.set_positions(cube, doubled);
    CHECK(loads.state(all[1]).force.z() == Approx(40).epsilon(0.01));
}

TEST_CASE("wrong loads of a scene are refused with file, object and field", "[unit]") {
    CHECK_THAT(refusal_of(R"({"kind": "force", "body": "cub", "nodes": [1], "force": [1, 0, 0]})"),
               Contains("scene.json") && Contains("body") && Contains("\"cub\"") && Contains("\"cube\""));
    CHECK_THAT(refusal_of(R"({"kind": "force", "body": "cube", "force": [1, 0, 0]})"),
               Contains("none of the keys") && Contains("\"set\""));
    CHECK_THAT(refusal_of(R"({"kind": "force", "body": "cube", "set": "side", "force": [1, 0, 0]})"),
               Contains("\"side\"") && Contains("\"top\""));
    CHECK_THAT(refusal_of(R"({"kind": "traction", "body": "cube", "nodes": [0, 1], "traction": [1, 0, 0]})"),
               Contains("no face"));
    CHECK_THAT(refusal_of(R"({"kind": "force", "body": "cube", "set": "top"})"), Contains("no key \"force\""));
    CHECK_THAT(refusal_of(R"({"kind": "gravity", "scale": 1, "wind": [1, 0, 0]})"),
               Contains("wind") && Contains("not used by a load of the kind \"gravity\""));
    CHECK_THAT(refusal_of(R"({"kind": "drag", "rate": 1, "area": "present"})"),
               Contains("area") && Contains("not used"));
    CHECK_THAT(refusal_of(R"({"kind": "drag", "rate": 0})"), Contains("rate"));
    CHECK_THAT(refusal_of(R"({"kind": "gravity", "scale": [[1, 0], [0, 1]]})"), Contains("scale"));
}

}  // namespace skerry::test::scene_loads_test
