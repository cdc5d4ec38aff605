// Friction by pair of materials in scene files.
#include <catch2/catch.hpp>
#include <string>

#include "engine/scene/scene_plan.h"
#include "skerry/surface.h"
#include "tests/unit/engine/scene_files.h"

namespace skerry::test::scene_surface_test {

namespace {

std::string scene(const std::string& pairs, const std::string& collider) {
    return R"({"materials": {"rubber": {"mu": 0.9}, "steel": {"mu": 0.4}},
        "bodies": [{"name": "block", "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber"}],
        "colliders": [{"shape": {"plane": {}}, "position": [0, 0, -0.5], )" +
           collider + R"(}], "pairs": [)" + pairs + "]}";
}

std::string refusal(const std::string& pairs, const std::string& collider = R"("material": "steel")") {
    const TemporaryFolder folder;
    try {
        build_scene(plan_scene(folder.write("s.json", scene(pairs, collider))));
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a scene sets the friction of a pair of materials and the material of a collider", "[unit][surface]") {
    const TemporaryFolder folder;
    Scene built = build_scene(plan_scene(
        folder.write("s.json", scene(R"({"materials": ["steel", "rubber"], "friction": 0.7, "restitution": 0.2})",
                                     R"("material": "steel")"))));
    SurfacePairs pairs(built.world);
    const std::vector<MaterialHandle> materials = built.world.materials();
    REQUIRE(pairs.all().size() == 1);
    CHECK(pairs.surface(materials[0], materials[1])->friction == 0.7);
    CHECK(pairs.surface(materials[1], materials[0])->restitution == 0.2);
    CHECK(pairs.material(built.world.colliders()[0]) == materials[1]);
}

TEST_CASE("errors of pairs name the file, the place and the materials", "[unit][surface]") {
    using Catch::Matchers::Contains;
    CHECK_THAT(refusal(R"({"materials": ["steel", "rubbber"], "friction": 0.7})"),
               Contains("s.json") && Contains("pairs[0].materials[1]") && Contains("\"rubber\""));
    CHECK_THAT(refusal(R"({"materials": ["steel"], "friction": 0.7})"),
               Contains("pairs[0].materials") && Contains("a list of 2 texts"));
    CHECK_THAT(refusal(R"({"materials": ["steel", "rubber"], "friction": -1})"), Contains("pairs[0].friction"));
    CHECK_THAT(refusal(R"({"materials": ["steel", "rubber"], "static_friction": 0.1, "dynamic_friction": 0.2})"),
               Contains("pairs[0].dynamic_friction"));
    CHECK_THAT(refusal("", R"("material": "ice")"), Contains("colliders[0].material") && Contains("\"steel\""));
}

}  // namespace skerry::test::scene_surface_test
