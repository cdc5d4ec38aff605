// Friction by pair of materials and by place in scene files.
#include <catch2/catch.hpp>
#include <string>

#include "engine/scene/scene_plan.h"
#include "skerry/surface.h"
#include "tests/support/message_of.h"
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
    return message_of([&] { build_scene(plan_scene(folder.write("s.json", scene(pairs, collider)))); });
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
    CHECK_THAT(refusal(R"({"materials": ["steel", "rubber"], "mu": 1}, {"materials": ["rubber", "steel"], "mu": 2})"),
               Contains("pairs[1].materials") && Contains("a second pair of \"rubber\" and \"steel\""));
    CHECK_THAT(refusal("", R"("material": "ice")"), Contains("colliders[0].material") && Contains("\"steel\""));
}

TEST_CASE("a scene gives parts of a surface their own friction", "[unit][surface]") {
    const TemporaryFolder folder;
    const std::string sets = R"("sets": {"bottom": {"half_space": {"normal": [0, 0, -1], "point": [0, 0, -0.49]}}}, )";
    Scene built = build_scene(
        plan_scene(folder.write("s.json", body_with(sets + R"("positions": [[0, 0, 0], [5, 0, 0]], "surfaces": [
            {"set": "bottom", "mu": 0.2, "friction_across": 0.5, "direction": [0, 3, 0]},
            {"box": {"lower": [-1, -1, -1], "upper": [0, 1, 1]}, "restitution": 0.4}])"))));
    SurfaceSets found(built.world);
    REQUIRE(found.all().size() == 4);
    const SurfaceSetSettings ski = found.settings(found.all()[2]), left = found.settings(found.all()[3]);
    CHECK(ski.body == built.world.bodies()[1]);
    CHECK(ski.nodes.size() + 3 * ski.faces.size() >= 4);
    CHECK(ski.surface.friction == 0.2);
    CHECK(*ski.friction_across == Approx(0.5));
    CHECK(*ski.direction == Vec3(0, 1, 0));
    CHECK(left.surface.restitution == 0.4);
    CHECK(!left.surface.friction);
    const auto fault = [&](const std::string& surface) {
        return message_of([&] {
            build_scene(plan_scene(folder.write("s.json", body_with(sets + "\"surfaces\": [" + surface + "]"))));
        });
    };
    using Catch::Matchers::Contains;
    CHECK_THAT(fault(R"({"set": "botom", "friction": 1})"), Contains("surfaces[0].set") && Contains("bottom"));
    CHECK_THAT(fault(R"({"set": "bottom", "friction": 1, "friction_across": 2})"), Contains("direction"));
    CHECK_THAT(fault(R"({"set": "bottom", "friction_across": 2, "direction": [1, 0, 0]})"),
               Contains("surfaces[0]") && Contains("friction"));
    CHECK_THAT(fault(R"({"friction": 1})"), Contains("surfaces[0]") && Contains("\"set\""));
}

}  // namespace skerry::test::scene_surface_test
