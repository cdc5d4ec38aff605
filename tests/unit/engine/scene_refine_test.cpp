// Refined and coarser meshes of a scene, and scene files with other values.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "engine/scene/mesh_levels.h"
#include "engine/scene/scene_plan.h"
#include "engine/scene/write_scene.h"
#include "skerry/refine.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::scene_refine_test {

using Catch::Matchers::Contains;

namespace {

/// A box with an empty cell in its middle.
Mesh hollow_box() {
    Mesh mesh = mesh::box({0.3, 0.3, 0.3}, {3, 3, 3});
    std::erase_if(mesh.tetrahedra, [&](const auto& t) {
        Vec3 middle = Vec3::Zero();
        for (const Index n : t) middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
        return middle.cwiseAbs().maxCoeff() < 0.05;
    });
    return mesh;
}

std::vector<Index> nodes_at(const Mesh& mesh, Index axis, Real side) {
    std::vector<Index> nodes;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n][axis] - side) < 1e-9) nodes.push_back(static_cast<Index>(n));
    return nodes;
}

std::string list_of(const std::vector<Index>& numbers) {
    std::string text;
    for (const Index n : numbers) text += (text.empty() ? "[" : ", ") + std::to_string(n);
    return text + "]";
}

/// VTK file of a mesh with the labels 1 and 2, the sets "end" and "core", and the vectors "grain".
std::string vtk_text(const Mesh& mesh) {
    std::ostringstream out;
    out.precision(17);
    out << "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << mesh.nodes.size()
        << " double\n";
    for (const Vec3& x : mesh.nodes) out << x.transpose() << "\n";
    const std::size_t count = mesh.tetrahedra.size();
    out << "CELLS " << count << ' ' << 5 * count << "\n";
    for (const auto& [a, b, c, d] : mesh.tetrahedra) out << "4 " << a << ' ' << b << ' ' << c << ' ' << d << "\n";
    out << "CELL_TYPES " << count << "\n";
    for (std::size_t t = 0; t < count; ++t) out << "10\n";
    out << "POINT_DATA " << mesh.nodes.size() << "\nSCALARS end int\nLOOKUP_TABLE default\n";
    for (const Vec3& x : mesh.nodes) out << (x.x() > 0.149) << "\n";
    const auto for_each_middle = [&](auto write) {
        for (const auto& t : mesh.tetrahedra) {
            Vec3 middle = Vec3::Zero();
            for (const Index n : t) middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
            write(middle);
        }
    };
    out << "CELL_DATA " << count << "\nSCALARS region int\nLOOKUP_TABLE default\n";
    for_each_middle([&](const Vec3& x) { out << (x.z() > 0.05 ? 2 : 1) << "\n"; });
    out << "SCALARS core int\nLOOKUP_TABLE default\n";
    for_each_middle([&](const Vec3& x) { out << (x.z() < -0.05) << "\n"; });
    out << "VECTORS grain double\n";
    for_each_middle([&](const Vec3& x) { out << Vec3(1, x.x(), 0).transpose() << "\n"; });
    return out.str();
}

/// A scene that names parts of the hollow box in all ways.
std::string scene_text() {
    const Mesh box = hollow_box();
    return R"({"materials": {"soft": {"rho": 1000}, "hard": {"rho": 3000}, "heavy": {"rho": 5000}},
        "bodies": [{"name": "box", "mesh": {"file": "box.vtk", "scale": 2}, "material": "soft",
            "materials": {"2": "hard", "core": "heavy"}, "positions": [[0, 0, 0], [2, 0, 0]],
            "sets": {"top": {"surface": true, "half_space": {"point": [0, 0, 0.299]}},
                     "listed": {"nodes": )" +
           list_of(nodes_at(box, 1, 0.15)) + R"(}},
            "pin": [{"set": "end"}, {"nodes": )" +
           list_of(nodes_at(box, 0, -0.15)) + R"(}],
            "surfaces": [{"set": "top", "friction": 0.1}, {"nodes": )" +
           list_of(nodes_at(box, 2, -0.15)) + R"(, "friction": 0.2}], "visual": "skin.obj"}],
        "ties": [{"body": "box_0", "nodes": )" +
           list_of(nodes_at(box, 1, -0.15)) + R"(}],
        "cavities": [{"name": "hole", "body": "box_1", "pressure": 10}],
        "loads": [{"kind": "force", "body": "box_0", "set": "listed", "force": [1, 2, 3]},
                  {"kind": "traction", "body": "box_1", "set": "top", "traction": [1, 2, 10]}],
        "fibres": [{"body": "box_0", "set": "core", "direction_array": "grain", "tension": 1}],
        "springs": [{"first": {"body": "box_0", "point": [0.21, 0.1, 0.3]}, "second": {"point": [0, 0, 1]},
                     "stiffness": 1}],
        "probes": [{"name": "tip", "quantity": "motion", "body": "box_1", "point": [0.21, 0.1, 0.07]},
                   {"name": "contact", "body": "box_1", "set": "top"},
                   {"name": "stress", "quantity": "stress", "body": "box_1", "set": "end"}]})";
}

/// Area of the surface faces whose nodes all belong to a part [m^2].
Real area_of(const std::vector<Index>& nodes, const Mesh& mesh) {
    MeshSet set{.nodes = nodes};
    std::ranges::sort(set.nodes);
    Real area = 0;
    for (const auto& [a, b, c] : faces_of(set, mesh)) {
        const auto at = [&](Index n) -> const Vec3& { return mesh.nodes[static_cast<std::size_t>(n)]; };
        area += (at(b) - at(a)).cross(at(c) - at(a)).norm() / 2;
    }
    return area;
}

/// Areas, volumes, masses and forces of the scene, which refinement must not change. With more than one refinement
/// only those that need no world.
std::vector<std::pair<std::string, Real>> measures(const std::filesystem::path& scene, int refine) {
    const ScenePlan plan = plan_scene(scene, {.assignments = {"bodies[0].mesh.refine=" + std::to_string(refine)}});
    REQUIRE(plan.meshes.size() == 1);  // copies share the mesh
    const Mesh& mesh = plan.meshes[0];
    REQUIRE(mesh.tetrahedra.size() == hollow_box().tetrahedra.size() << 3 * refine);
    const BodyPlan& body = plan.bodies[0];
    std::vector<std::pair<std::string, Real>> all;
    for (const PinPlan& pin : body.pins) all.emplace_back("pinned area", area_of(pin.nodes, mesh));
    for (const SurfacePlan& surface : body.surfaces) {
        const MeshSet set{.nodes = surface.settings.nodes, .faces = surface.settings.faces};
        all.emplace_back("surface", area_of(mesh::nodes_of(set, mesh.tetrahedra), mesh));
    }
    all.emplace_back("tied area", area_of(plan.ties[0].settings.nodes, mesh));
    all.emplace_back("contact probe", area_of(plan.probes[0].nodes, mesh));
    all.emplace_back("stress probe", area_of(plan.series[1].nodes, mesh));
    all.emplace_back("loaded set", area_of(body.sets.at("listed").nodes, mesh));
    const FibreSettings& fibres = plan.fibres[0].settings;
    Mesh fibre_part{.nodes = mesh.nodes, .tetrahedra = {}};
    Real tilt = 0;
    for (std::size_t i = 0; i < fibres.tetrahedra.size(); ++i) {
        fibre_part.tetrahedra.push_back(mesh.tetrahedra[static_cast<std::size_t>(fibres.tetrahedra[i])]);
        tilt += std::abs(fibres.direction[i].y()) / static_cast<Real>(fibres.tetrahedra.size());
    }
    all.emplace_back("volume of fibres", inspect(fibre_part).volume);
    all.emplace_back("direction of fibres", tilt);
    Vec3 tip = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a)
        tip += plan.series[0].point->weight[a] * mesh.nodes[static_cast<std::size_t>(plan.series[0].point->node[a])];
    for (const Real coordinate : tip) all.emplace_back("probe", coordinate);
    if (refine > 1) return all;
    Scene built = build_scene(plan);
    World& world = built.world;
    for (const BodyHandle b : world.bodies()) all.emplace_back("mass", world.mass(b));
    all.emplace_back("cavity", Cavities(world).state(Cavities(world).all()[0]).volume);
    for (const LoadHandle load : Loads(world).all())
        for (const Real force : Loads(world).state(load).force) all.emplace_back("force", force);
    all.emplace_back("spring", Springs(world).state(Springs(world).all()[0]).length);
    return all;
}

std::string with_mesh(const std::string& mesh, const std::string& more = {}) {
    return R"({"materials": {"soft": {}}, "bodies": [{"name": "b", "material": "soft", "mesh": )" + mesh + more + "}]}";
}

Mesh mesh_of(const std::string& mesh) {
    const TemporaryFolder folder;
    return plan_scene(folder.write("scene.json", with_mesh(mesh))).meshes[0];
}

bool same(const Mesh& a, const Mesh& b) {
    return a.nodes == b.nodes && a.tetrahedra == b.tetrahedra;
}

std::string refusal(const std::string& mesh, const std::string& more = {}) {
    const TemporaryFolder folder;
    folder.write("box.vtk", vtk_text(hollow_box()));
    const std::filesystem::path scene = folder.write("scene.json", with_mesh(mesh, more));
    return message_of([&] { plan_scene(scene); });
}

}  // namespace

TEST_CASE("refinement changes no mass, area, volume or force of a scene", "[unit]") {
    const TemporaryFolder folder;
    folder.write("box.vtk", vtk_text(hollow_box()));
    folder.write("skin.obj", "v 0.1 0 0.3\nv 0.2 0 0.3\nv 0.1 0.1 0.3\nf 1 2 3\n");
    const std::filesystem::path scene = folder.write("scene.json", scene_text());
    const auto given = measures(scene, 0);
    for (const int level : {1, 2}) {
        const auto refined = measures(scene, level);
        for (std::size_t i = 0; i < refined.size(); ++i) {
            INFO(given[i].first << " at level " << level);
            CHECK(given[i].second != 0);
            CHECK(refined[i].second == Approx(given[i].second).epsilon(1e-12));
        }
    }
}

TEST_CASE("refined shapes have more or fewer cells", "[unit]") {
    CHECK(same(mesh_of(R"({"box": {"size": [1, 2, 3], "cells": [2, 4, 6]}, "refine": 2})"),
               mesh::box({1, 2, 3}, {8, 16, 24})));
    CHECK(same(mesh_of(R"({"box": {"size": [1, 2, 3], "cells": [2, 4, 6]}, "refine": -1})"),
               mesh::box({1, 2, 3}, {1, 2, 3})));
    CHECK(same(mesh_of(R"({"ball": {"radius": 1, "resolution": 3}, "refine": 1})"), mesh::ball(1, 8)));
    CHECK(same(mesh_of(R"({"ball": {"radius": 1, "resolution": 7}, "refine": -2})"), mesh::ball(1, 2)));
    CHECK(same(mesh_of(R"({"cylinder": {"radius": 1, "height": 2, "resolution": 4}, "refine": 1})"),
               mesh::cylinder(1, 2, 8)));
    const std::array<std::array<Real, 2>, 2> cone{{{1, 0}, {0.5, 1}}};
    CHECK(same(mesh_of(R"({"lathe": {"profile": [[1, 0], [0.5, 1]], "resolution": 4}, "refine": 1})"),
               mesh::lathe(cone, 8)));
    CHECK(same(mesh_of(R"({"skittle": {"height": 0.4, "resolution": 6}, "refine": 1})"), mesh::skittle(0.4, 12)));
    CHECK(same(mesh_of(R"({"table": {"cells_per_leg": 2}, "refine": 1})"),
               mesh::refine(mesh::table({.cells_per_leg = 2}))));
    CHECK(same(mesh_of(R"({"table": {"cells_per_leg": 2}, "refine": -1})"), mesh::table({.cells_per_leg = 1})));
}

TEST_CASE("impossible refinements are refused with the reason", "[unit]") {
    const std::string box = R"({"box": {"size": [1, 1, 1], "cells": [4, 2, 2]}, "refine": )";
    CHECK_THAT(refusal(box + "7}"),
               Contains("bodies[0].mesh.refine: found 7, expected a whole number") && Contains("-6") && Contains("6"));
    CHECK_THAT(refusal(box + "0.5}"), Contains("refine: found the number 0.5, expected a whole number"));
    CHECK_THAT(refusal(box + "-2}"), Contains("body \"b\": bodies[0].mesh.refine: found -2") &&
                                         Contains("cells [4, 2, 2] cannot be halved 2 times without remainder"));
    CHECK_THAT(refusal(R"({"ball": {"radius": 1, "resolution": 6}, "refine": -1})"),
               Contains("resolution 6 cannot be halved without remainder"));
    CHECK(refusal(box + "-1}").empty());
    CHECK_THAT(refusal(box + "1}", R"(, "pin": {"nodes": [0]})"),
               Contains("bodies[0].pin.nodes names nodes by number, and the mesh would have other nodes"));
    const std::string tied = R"(, "positions": [[0, 0, 0], [3, 0, 0]]}, {"name": "b_lid", "material": "soft",
        "shape": {"sphere": {"radius": 1}}, "dynamics": "rigid"}], "ties": [{"body": "b_1", )";
    CHECK_THAT(refusal(box + "1}", tied + R"("nodes": [0])"), Contains("ties[0].nodes names nodes by number"));
    const std::string file = R"({"file": "box.vtk", "refine": -1})";
    CHECK_THAT(refusal(file, R"(, "pin": {"set": "end"})"),
               Contains("bodies[0].pin.set names a part of the mesh file, which a coarser mesh does not have"));
    CHECK_THAT(refusal(file, R"(, "materials": {"2": "soft"})"), Contains("bodies[0].materials.2 names a part"));
    CHECK_THAT(refusal(file, R"(, "sets": {"s": {"label": 2}})"), Contains("bodies[0].sets.s.label names a part"));
    CHECK_THAT(refusal(file, R"(, "dynamics": "rigid")"),
               Contains("only deformable bodies get coarser meshes in place of a file"));
    CHECK_THAT(refusal(R"({"file": "box.vtk", "refine": 1})", R"(, "pin": {"nodes": [70]})"),
               Contains("found node 70, expected a node number below 64"));
}

TEST_CASE("the levels of a scene are those that all its meshes allow", "[unit]") {
    const TemporaryFolder folder;
    mesh::write((folder.path() / "part.msh").string(), hollow_box());
    folder.write("inner.json", with_mesh(R"({"ball": {"radius": 0.1, "resolution": 4}})"));
    const auto levels = [&](const std::string& more) {
        const std::filesystem::path scene = folder.write("scene.json", R"({"materials": {"rubber": {}}, "bodies": [
                {"mesh": {"box": {"size": [1, 1, 1], "cells": [8, 4, 4]}, "refine": 1}, "material": "rubber"},
                {"shape": {"sphere": {"radius": 0.1}}, "material": "rubber", "position": [3, 0, 0]},
                {"mesh": {"file": "part.msh"}, "dynamics": "rigid", "material": "rubber", "position": [6, 0, 0]}],
                "colliders": [{"position": [9, 0, 0],
                               "shape": {"mesh": {"ball": {"radius": 0.1, "resolution": 4}}}}])" +
                                                                           more + "}");
        return levels_of(read_scene_file(scene), scene);
    };
    const SceneLevels own = levels("");
    CHECK(own.coarsest == -1);
    CHECK_THAT(own.why_not_coarser, Contains("colliders[0].shape.mesh: resolution 4 cannot be halved 2 times"));
    CHECK(own.finest == 5);
    CHECK_THAT(own.why_not_finer, Contains("bodies[0].mesh: values are limited to 6 refinements"));
    CHECK(own.assignments(1) ==
          std::vector<std::string>{"bodies[0].mesh.refine=2", "colliders[0].shape.mesh.refine=1"});
    const SceneLevels with_include = levels(R"(, "include": "inner.json")");
    CHECK(with_include.finest == 0);
    CHECK_THAT(with_include.why_not_finer, Contains("it is in the included scene") && Contains("inner.json"));
}

TEST_CASE("a scene file that is written with assignments runs as the scene does with them", "[unit]") {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "scenes");
    mesh::write((folder.path() / "part.msh").string(), hollow_box());
    folder.write("skin.obj", "v 0.1 0 0\nv 0.2 0 0\nv 0.1 0.1 0\nf 1 2 3\n");
    folder.write("scenes/inner.json", R"({"materials": {"steel": {"E": 1e6}}})");
    const std::filesystem::path scene = folder.write("scenes/scene.json", R"({
        "$schema": "../scene.schema.json", "name": "fall", "include": ["inner.json"],
        "materials": {"rubber": {"E": 1e5}},
        "bodies": [{"visual": "../skin.obj", "mesh": {"file": "../part.msh", "scale": 0.5}, "material": "rubber",
                    "position": [0, 0, 0.2]},
                   {"visual": {"file": "../skin.obj", "scale": 2}, "mesh": {"box": {"size": [1, 1, 1],
                    "cells": [2, 1, 1]}}, "material": "steel", "position": [0, 3, 0.6]}],
        "colliders": [{"shape": {"plane": {}}},
                      {"shape": {"mesh": {"file": "../part.msh"}}, "position": [5, 0, 0]}]})");
    const std::vector<std::string> assignments{"bodies[0].mesh.refine=1", "settings.step_size=1e-4", "seconds=0.5"};
    const std::filesystem::path copy = folder.path() / "results/best.json";
    write_scene(copy, scene, assignments);
    const auto hash_after_steps = [](Scene loaded) {
        for (int step = 0; step < 5; ++step) REQUIRE(loaded.world.advance(1e-4).ok());
        return loaded.world.state_hash();
    };
    const std::uint64_t hash = hash_after_steps(load_scene(copy));
    CHECK(hash == hash_after_steps(load_scene(scene, {.assignments = assignments})));
    CHECK(hash != hash_after_steps(load_scene(scene)));

    std::ifstream in(copy);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    CHECK_THAT(text, Contains("\"../scene.schema.json\"") && Contains("\"../scenes/inner.json\""));
    CHECK(text.find("\"visual\"") < text.find("\"mesh\""));  // the order of the given file
}

}  // namespace skerry::test::scene_refine_test
