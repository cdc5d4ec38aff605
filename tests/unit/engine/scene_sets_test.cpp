// Named sets of bodies in scene files, and the entries that use them.
#include <catch2/catch.hpp>

#include "engine/scene/scene_plan.h"
#include "skerry/sets.h"
#include "systems/collision/build_surface.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::scene_sets_test {

using Catch::Matchers::Contains;

namespace {

/// Plans a scene with a unit cube of 2 x 2 x 2 cells, centred at the origin. `body` ends the body, `scene` the scene.
ScenePlan plan_of(const std::string& body, const std::string& scene = {}) {
    const TemporaryFolder folder;
    return plan_scene(folder.write("scene.json", R"({"materials": {"soft": {"rho": 1000}, "hard": {"rho": 3000}},
        "bodies": [{"name": "cube", "material": "soft", "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}}, )" +
                                                     body + "}]" + scene + "}"));
}

std::string refusal(const std::string& body, const std::string& scene = {}) {
    return message_of([&] { plan_of(body, scene); });
}

std::size_t node_count(const std::string& entry) {
    const ScenePlan plan = plan_of(R"("sets": {"s": )" + entry + "}");
    return nodes_of({.set = "s", .box = {}, .nodes = {}, .place = {}}, plan.bodies[0], plan).size();
}

}  // namespace

TEST_CASE("a set contains the parts of a body that meet all conditions", "[unit]") {
    CHECK(node_count(R"({"box": {"lower": [-1, -1, 0.4], "upper": [1, 1, 1]}})") == 9);
    CHECK(node_count(R"({"sphere": {"center": [0, 0, 0], "radius": 0.6}})") == 7);
    CHECK(node_count(R"({"half_space": {"point": [0, 0, 0.25], "normal": [0, 0, -2]}})") == 18);
    CHECK(node_count(R"({"surface": true})") == 26);
    CHECK(node_count(R"({"surface": true, "half_space": {"point": [0, 0, 0.4]}})") == 9);
    CHECK(node_count(R"({"nodes": [3, 5]})") == 2);
}

TEST_CASE("sets are combined by name", "[unit]") {
    const ScenePlan plan = plan_of(R"("sets": {
        "top": {"half_space": {"point": [0, 0, 0.4]}},
        "bottom": {"half_space": {"point": [0, 0, -0.4], "normal": [0, 0, -1]}},
        "ends": {"set": ["top", "bottom"]},
        "edge": {"set": "ends", "half_space": {"point": [0.4, 0, 0], "normal": [1, 0, 0]}}},
        "pin": {"set": "ends"})",
                                   R"(, "probes": [{"name": "p", "body": "cube", "set": "edge"},
                                     {"name": "q", "body": "cube", "quantity": "stress", "set": "top"}])");
    CHECK(plan.bodies[0].pins[0].nodes.size() == 18);
    CHECK(plan.probes[0].nodes.size() == 6);
    CHECK(plan.series[0].nodes.size() == 9);
    const auto faces = faces_of({.set = "top", .box = {}, .nodes = {}, .place = {}}, plan.bodies[0], plan);
    CHECK(faces.size() == 8);
    // the built body has the sets of the scene
    Scene scene = build_scene(plan);
    CHECK(Sets(scene.world).names(scene.world.bodies()[0]) ==
          std::vector<std::string>{"bottom", "edge", "ends", "top"});
}

TEST_CASE("surface drops the faces of a set that are inside of the mesh", "[unit]") {
    const TemporaryFolder folder;
    Mesh mesh = mesh::box({1, 1, 1}, {1, 1, 1});
    const std::array<Index, 4> first = mesh.tetrahedra.front();
    mesh.sets["faces"] = {.faces = {{first[0], first[1], first[2]},
                                    {first[0], first[1], first[3]},
                                    {first[0], first[2], first[3]},
                                    {first[1], first[2], first[3]}}};
    mesh::write((folder.path() / "m.msh").string(), mesh);
    const ScenePlan plan = plan_scene(folder.write("scene.json", R"({"materials": {"soft": {}},
        "bodies": [{"material": "soft", "mesh": {"file": "m.msh"}, "sets": {"skin": {"set": "faces", "surface": true}},
                    "surfaces": [{"set": "skin", "mu": 0.1}]}]})"));
    const std::size_t outside = plan.bodies[0].sets.at("skin").faces.size();
    CHECK(outside > 0);
    CHECK(outside < 4);
    CHECK(plan.bodies[0].surfaces[0].settings.faces.size() == outside);
    CHECK_NOTHROW(build_scene(plan));
}

TEST_CASE("loads, cavities and surfaces use nodes, faces and tetrahedra of a set together", "[unit]") {
    const TemporaryFolder folder;
    Mesh mesh = mesh::box({1, 1, 1}, {2, 1, 1});
    const auto corners = boundary_triangles(mesh.tetrahedra).front().node;
    std::vector<Index> right;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].x() > 0.4) right.push_back(static_cast<Index>(n));
    mesh.sets["mixed"] = {.nodes = right, .faces = {corners}};
    mesh::write((folder.path() / "m.msh").string(), mesh);
    const ScenePlan plan = plan_scene(folder.write("scene.json", R"({"materials": {"soft": {}},
        "bodies": [{"name": "b", "material": "soft", "mesh": {"file": "m.msh"},
                    "surfaces": [{"set": "mixed", "mu": 0.1}]}],
        "loads": [{"kind": "traction", "body": "b", "set": "mixed", "traction": [0, 0, 1]}],
        "cavities": [{"body": "b", "set": "mixed", "pressure": 1}]})"));
    CHECK(plan.bodies[0].surfaces[0].settings.faces.size() == 3);
    CHECK(plan.bodies[0].surfaces[0].settings.nodes == right);
    CHECK(std::get<TractionLoad>(plan.loads[0].load).faces.size() == 3);
    REQUIRE(plan.cavities[0].settings.faces.has_value());
    CHECK(plan.cavities[0].settings.faces->size() == 3);
}

TEST_CASE("the tetrahedra of a set have the material of the set", "[unit]") {
    const ScenePlan plan = plan_of(R"("sets": {"upper": {"half_space": {}}}, "materials": {"upper": "hard"})");
    const Scene scene = build_scene(plan);
    CHECK(scene.world.mass(scene.world.bodies()[0]) == Approx(0.5 * 1000 + 0.5 * 3000));
}

TEST_CASE("sets that are unknown, empty or ambiguous are refused by name", "[unit]") {
    CHECK_THAT(
        refusal(R"("sets": {"top": {"half_space": {}}, "base": {"nodes": [1]}}, "pin": {"set": "tip"})"),
        Contains("body \"cube\": bodies[0].pin.set: found \"tip\", expected one of the sets \"base\", \"top\"") &&
            Contains("did you mean \"top\"?"));
    CHECK_THAT(refusal(R"("pin": {"set": "tip"})"), Contains("found \"tip\", expected no set, because there are none"));
    CHECK_THAT(refusal(R"("sets": {"far": {"half_space": {"point": [0, 0, 9]}}})"),
               Contains("bodies[0].sets.far: found conditions that no part of the mesh meets"));
    CHECK_THAT(refusal(R"("sets": {"a": {"set": "b"}, "b": {"nodes": [1]}})"),
               Contains("bodies[0].sets.a.set: found \"b\""));
    CHECK_THAT(refusal(R"("sets": {"a": {"label": 3}})"), Contains("bodies[0].sets.a.label: found label 3"));
    CHECK_THAT(refusal(R"("pin": {"set": "a", "nodes": [1]})"), Contains("exactly one of the keys"));
    CHECK_THAT(
        refusal(R"("sets": {"a": {"nodes": [1]}})", R"(, "probes": [{"name": "p", "body": "cube", "set": "b"}])"),
        Contains("probe \"p\": probes[0].set: found \"b\", expected one of the sets \"a\""));
    CHECK_THAT(
        refusal({R"("materials": {"upper": "hard"})"}),
        Contains("bodies[0].materials.upper: found the key \"upper\", expected no label, because the mesh has no "
                 "labels, or no set, because there are none"));
    for (const char* key : {"1.5", "01", "+1", "3000000000"})
        CHECK_THAT(refusal(R"("materials": {")" + std::string(key) + R"(": "hard"})"),
                   Contains("found the key \"" + std::string(key) + '"'));
}

TEST_CASE("tetrahedra with two materials are refused", "[unit]") {
    const ScenePlan plan = plan_of(
        R"("sets": {"a": {"half_space": {}}, "b": {"surface": false}}, "materials": {"a": "hard", "b": "soft"})");
    CHECK_THROWS_WITH(build_scene(plan),
                      Contains("materials_of_sets: found tetrahedron") && Contains("in both \"a\" and \"b\""));
}

TEST_CASE("a pin holds along the axes or the direction that it names", "[unit]") {
    const ScenePlan plan =
        plan_of(R"("pin": [{"nodes": [0], "axes": ["z", "x"]}, {"nodes": [1], "direction": [0, 2, 0]},
                                              {"nodes": [2]}])");
    CHECK(plan.bodies[0].pins[0].directions == std::vector<Vec3>{Vec3::UnitZ(), Vec3::UnitX()});
    CHECK(plan.bodies[0].pins[1].directions == std::vector<Vec3>{{0, 2, 0}});
    CHECK(plan.bodies[0].pins[2].directions.empty());
    CHECK_THAT(refusal(R"("pin": {"nodes": [0], "axes": []})"), Contains("pin.axes: found an empty list"));
    CHECK_THAT(refusal(R"("pin": {"nodes": [0], "axes": ["w"]})"), Contains("\"x\", \"y\", \"z\""));
    CHECK_THAT(refusal(R"("pin": {"nodes": [0], "axes": ["x"], "direction": [1, 0, 0]})"), Contains("at most one of"));
}

}  // namespace skerry::test::scene_sets_test
