// Resolution of scenes: meshes, copies, names, pins, probes, overrides.
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <string>

#include "engine/scene/scene_plan.h"
#include "skerry/joint.h"
#include "skerry/mesh.h"
#include "tests/support/message_of.h"
#include "tests/unit/engine/scene_files.h"

namespace skerry::test::scene_plan_test {

TEST_CASE("a grid of copies has the same jitter every time, and another one for another seed", "[unit][determinism]") {
    const TemporaryFolder folder;
    const auto grid = [&](int seed) {
        return plan_scene(folder.write("g.json", body_with(
                                                     R"("position": [0, 0, 1],
                   "repeat": {"count": [2, 3, 2], "spacing": [2, 3, 4], "jitter": 0.1, "seed": )" +
                                                     std::to_string(seed) + "}")));
    };
    const ScenePlan one = grid(1), again = grid(1), other = grid(2);
    REQUIRE(one.bodies.size() == 12);
    CHECK(one.meshes.size() == 1);  // copies share the mesh
    CHECK(one.bodies[0].settings.name == "block_0");
    CHECK(one.bodies[11].settings.name == "block_11");
    std::set<Real> shifts;
    bool differs = false;
    for (std::size_t i = 0; i < 12; ++i) {
        const Vec3 position = one.bodies[i].settings.position;
        CHECK(position == again.bodies[i].settings.position);
        differs = differs || position != other.bodies[i].settings.position;
        const Vec3 regular(2.0 * static_cast<Real>(i % 2), 3.0 * static_cast<Real>(i / 2 % 3),
                           1 + 4.0 * static_cast<Real>(i / 6));
        CHECK((position - regular).cwiseAbs().maxCoeff() <= 0.1 + 1e-12);  // rounding of the sum
        shifts.insert((position - regular).x());
    }
    CHECK(shifts.size() == 12);
    CHECK(differs);
}

TEST_CASE("a mesh file that several bodies name is read once, by its scale", "[unit]") {
    const TemporaryFolder folder;
    mesh::write((folder.path() / "ball.msh").string(), mesh::ball(1, 3));
    const ScenePlan plan = plan_scene(folder.write("f.json", R"({"materials": {"rubber": {}}, "bodies": [
        {"mesh": {"file": "ball.msh"}, "material": "rubber"},
        {"mesh": {"file": "ball.msh", "scale": 2}, "material": "rubber", "position": [9, 0, 0]},
        {"mesh": {"file": "ball.msh"}, "material": "rubber", "position": [5, 0, 0]}]})"));
    REQUIRE(plan.bodies.size() == 3);
    CHECK(plan.meshes.size() == 2);
    CHECK(plan.bodies[0].mesh == plan.bodies[2].mesh);
    const Mesh &one = plan.meshes[plan.bodies[0].mesh], &twice = plan.meshes[plan.bodies[1].mesh];
    CHECK(twice.nodes.back() == 2 * one.nodes.back());
}

TEST_CASE("without jitter a grid is exact", "[unit]") {
    const TemporaryFolder folder;
    const ScenePlan plan =
        plan_scene(folder.write("g.json", body_with(R"("repeat": {"count": [2, 1, 1], "spacing": [0.5, 0, 0]})")));
    REQUIRE(plan.bodies.size() == 2);
    CHECK(plan.bodies[1].settings.position == Vec3(0.5, 0, 0));
}

TEST_CASE("a material that is not there is named with the nearest one", "[unit]") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(plan_scene(folder.write("m.json",
                                              R"({"materials": {"rubber": {}, "wood": {}}, "bodies": [{"name": "b",
                "mesh": {"ball": {"radius": 1, "resolution": 3}}, "material": "ruber"}]})")),
                      Catch::Contains("body \"b\": bodies[0].material: found \"ruber\"") &&
                          Catch::Contains("\"rubber\", \"wood\"") && Catch::Contains("did you mean \"rubber\""));
}

namespace {

/// A scene whose body has `materials` and two tetrahedra with the labels 1 and 20.
std::string labelled_scene(const TemporaryFolder& folder, const std::string& materials) {
    folder.write("m.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n");
    folder.write("m.ele", "2 4 1\n1 1 2 3 4 1\n2 2 3 4 5 20\n");
    return folder.write("scene.json", R"({"materials": {"rubber": {"rho": 1000}, "steel": {"rho": 8000}}, "bodies": [
        {"name": "b", "mesh": {"file": "m.ele"}, "material": "rubber", "materials": )" +
                                          materials + "}]}");
}

}  // namespace

TEST_CASE("materials of tetrahedra are found by the labels of the mesh", "[unit]") {
    const TemporaryFolder folder;
    const ScenePlan plan = plan_scene(labelled_scene(folder, R"({"20": "steel"})"));
    REQUIRE(plan.bodies.size() == 1);
    CHECK(plan.meshes[0].label == std::vector<int>{1, 20});
    CHECK(plan.bodies[0].materials == std::vector<std::pair<int, std::size_t>>{{20, 1}});
    const Scene scene = build_scene(plan);
    CHECK(scene.world.mass(scene.world.bodies()[0]) == Approx(1000.0 / 6 + 8000.0 / 3));
}

TEST_CASE("errors about unknown labels and materials list the known ones", "[unit]") {
    const auto refusal = [](const std::string& materials) {
        const TemporaryFolder folder;
        return message_of([&] { plan_scene(labelled_scene(folder, materials)); });
    };
    CHECK_THAT(refusal(R"({"2": "steel"})"),
               Catch::Contains("body \"b\": bodies[0].materials.2: found label 2, expected one of the labels of the "
                               "mesh: 1, 20"));
    CHECK_THAT(refusal(R"({"1": "stele"})"),
               Catch::Contains("bodies[0].materials.1: found \"stele\"") && Catch::Contains("did you mean \"steel\""));
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(
        plan_scene(folder.write("box.json", body_with(R"("materials": {"1": "rubber"})"))),
        Catch::Contains(
            "found label 1, expected no label, because the mesh has no labels (use a mesh file with labels"));
}

TEST_CASE("two bodies of one name are refused", "[unit]") {
    const TemporaryFolder folder;
    const std::string body = R"({"name": "b", "mesh": {"ball": {"radius": 1, "resolution": 3}}, "material": "m"})";
    CHECK_THROWS_WITH(
        plan_scene(folder.write("n.json", R"({"materials": {"m": {}}, "bodies": [)" + body + ", " + body + "]}")),
        Catch::Contains("bodies[1].name: found \"b\", which is already the name of a body"));
}

TEST_CASE("a pin names the nodes of a mesh file by their numbers in the file", "[unit]") {
    const TemporaryFolder folder;
    // The nodes 0 and 3 of the file, counted from 0, belong to no tetrahedron.
    folder.write("m.node", "6 3 0 0\n1 5 5 5\n2 0 0 0\n3 1 0 0\n4 9 9 9\n5 0 1 0\n6 0 0 1\n");
    folder.write("m.ele", "1 4 0\n1 2 3 5 6\n");
    const auto plan_with = [&](const std::string& nodes) {
        return plan_scene(folder.write("s.json", R"({"materials": {"m": {}}, "bodies": [{"name": "b", "material": "m",
            "mesh": {"file": "m.ele"}, "pin": {"nodes": )" +
                                                     nodes + "}}]}"));
    };
    const ScenePlan plan = plan_with("[1, 4, 5]");
    std::vector<Vec3> held;
    for (const Index n : plan.bodies[0].pins[0].nodes)
        held.push_back(plan.meshes[0].nodes[static_cast<std::size_t>(n)]);
    CHECK(held == std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK_THROWS_WITH(plan_with("[1, 0]"),
                      Catch::Contains("body \"b\": bodies[0].pin.nodes[1]: found node 0, which no tetrahedron of the "
                                      "mesh file uses, expected the number of a node of a tetrahedron, from 1 to 5"));
    CHECK_THROWS_WITH(plan_with("[3]"), Catch::Contains("node 3, which no tetrahedron"));
    CHECK_THROWS_WITH(plan_with("[6]"), Catch::Contains("node 6"));
    CHECK_THROWS_WITH(plan_with("[5, 5]"), Catch::Contains("node 5 for the second time"));
}

TEST_CASE("pins take the nodes inside their box, and say when there are none", "[unit]") {
    const TemporaryFolder folder;
    const ScenePlan plan = plan_scene(folder.write(
        "p.json",
        body_with(
            R"("pin": {"box": {"lower": [-1, -1, -1], "upper": [1, 1, -0.4]}, "motion": {"velocity": [0, 0, 1]}})")));
    REQUIRE(plan.bodies[0].pins.size() == 1);
    CHECK(plan.bodies[0].pins[0].nodes.size() == 4);  // the lower face of one cell
    CHECK(plan.bodies[0].pins[0].motion.velocity == Vec3(0, 0, 1));
    CHECK(plan_scene(folder.write("q.json", body_with(R"("pin": [{"nodes": [0]}, {"nodes": [3, 2]}])")))
              .bodies[0]
              .pins.size() == 2);
    CHECK_THROWS_WITH(
        plan_scene(folder.write("e.json", body_with(R"("pin": {"box": {"lower": [5, 5, 5], "upper": [6, 6, 6]}})"))),
        Catch::Contains("bodies[0].pin.box: found a box that contains no node"));
    CHECK_THROWS_WITH(plan_scene(folder.write("f.json", body_with(R"("pin": [{"nodes": [0, 99]}])"))),
                      Catch::Contains("bodies[0].pin[0].nodes[1]: found node 99"));
    CHECK_THROWS_WITH(plan_scene(folder.write("h.json", body_with(R"("pin": {"nodes": [1, 1]})"))),
                      Catch::Contains("node 1 for the second time"));
}

TEST_CASE("probes find their body and nodes", "[unit]") {
    const TemporaryFolder folder;
    const auto with = [&](const std::string& body) {
        return plan_scene(
            folder.write("p.json", scene_with(R"("probes": [{"name": "south", "body": ")" + body +
                                              R"(", "box": {"lower": [-1, -1, -1], "upper": [1, 1, 0]}}])")));
    };
    const ScenePlan plan = with("ball");
    REQUIRE(plan.probes.size() == 1);
    CHECK_FALSE(plan.probes[0].nodes.empty());
    CHECK(plan.probes[0].nodes.size() < plan.meshes[0].nodes.size());
    CHECK_THROWS_WITH(with("bal"),
                      Catch::Contains("probe \"south\": probes[0].body: found \"bal\"") && Catch::Contains("\"ball\""));
}

TEST_CASE("probes of stress and volume are refused on rigid bodies", "[unit]") {
    const TemporaryFolder folder;
    const std::string of_mesh = body_with(R"("dynamics": "rigid")");
    const std::string of_shape = R"({"materials": {"rubber": {}},
        "bodies": [{"name": "block", "shape": {"sphere": {"radius": 1}}, "material": "rubber"}]})";
    for (const std::string& scene : {of_mesh, of_shape})
        for (const std::string quantity : {"stress", "volume"}) {
            const std::string probes =
                R"(, "probes": [{"name": "p", "quantity": ")" + quantity + R"(", "body": "block"}]})";
            CHECK_THROWS_WITH(
                plan_scene(folder.write("rigid.json", scene.substr(0, scene.size() - 1) + probes)),
                Catch::Contains("probes[0].body: found the rigid body \"block\", expected a body that deforms, "
                                "for the quantity \"" +
                                quantity + "\""));
        }
}

TEST_CASE("fibres that exert no force are refused", "[unit]") {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& keys) {
        return folder.write("fibres.json",
                            scene_with(R"("fibres": [{"body": "ball", "direction": [0, 0, 1])" + keys + "}]"));
    };
    CHECK_THROWS_WITH(plan_scene(file(R"(, "exponent": 2, "tension": [[0, 0], [1, 0]])")),
                      Catch::Contains("fibres[0]: found no \"stiffness\" and no \"tension\" above 0"));
    CHECK(plan_scene(file(R"(, "tension": [[0, 0], [1, 5]])")).fibres.size() == 1);
    CHECK(plan_scene(file(R"(, "stiffness": 5)")).fibres.size() == 1);
}

TEST_CASE("a scale stretches the mesh, overrides replace settings", "[unit]") {
    const TemporaryFolder folder;
    const std::string text =
        R"({"materials": {"m": {}}, "settings": {"threads": 4, "tolerance": 0.1}, "bodies": [{
            "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}, "scale": 2}, "material": "m"}]})";
    SceneOverrides overrides;
    overrides.threads = 1;
    const ScenePlan plan = plan_scene(folder.write("s.json", text), overrides);
    Real largest = 0;
    for (const Vec3& node : plan.meshes[0].nodes) largest = std::max(largest, node.cwiseAbs().maxCoeff());
    CHECK(largest == 1);
    CHECK(plan.settings.threads == 1);
    CHECK(plan.settings.tolerance == 0.1);
    CHECK(plan.bodies[0].settings.name == "body_0");
}

TEST_CASE("sizes that a built-in mesh refuses are refused with their place", "[unit]") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(plan_scene(folder.write("l.json",
                                              R"({"materials": {"m": {}}, "bodies": [{
                "mesh": {"lathe": {"profile": [[1, 1], [1, 0]], "resolution": 3}}, "material": "m"}]})")),
                      Catch::Contains("l.json: bodies[0].mesh: "));
}

TEST_CASE("a broken mesh file is refused with the scene's place and the mesh file's name", "[unit]") {
    const TemporaryFolder folder;
    folder.write("broken.msh", "$MeshFormat\nnonsense\n");
    CHECK_THROWS_WITH(
        plan_scene(folder.write(
            "b.json", R"({"materials": {"m": {}}, "bodies": [{"mesh": {"file": "broken.msh"}, "material": "m"}]})")),
        Catch::Contains("b.json: bodies[0].mesh: ") && Catch::Contains("broken.msh"));
}

namespace {

/// Two rigid blocks side by side and a joint with `keys`.
std::string jointed_scene(const std::string& keys) {
    const std::string block =
        R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber", "dynamics": "rigid")";
    return R"({"materials": {"rubber": {}}, "bodies": [{"name": "door", )" + block + R"(}, {"name": "frame", )" +
           block + R"(, "position": [1.01, 0, 0]}], "joints": [{)" + keys + "}]}";
}

}  // namespace

TEST_CASE("joints of a scene join its bodies by name", "[unit]") {
    const TemporaryFolder folder;
    Scene scene = load_scene(folder.write("joint.json", jointed_scene(R"("kind": "hinge", "first": "door",
        "second": "frame", "point": [0.505, 0, 0], "axis": [0, 0, 2], "lower": -1, "upper": 2,
        "motor": {"speed": 0.5, "strength": 3})")));
    Joints joints(scene.world);
    REQUIRE(joints.all().size() == 1);
    const JointState state = joints.state(joints.all()[0]);
    CHECK(state.kind == JointKind::hinge);
    CHECK(scene.world.name(state.first) == "door");
    REQUIRE(state.second);
    CHECK(scene.world.name(*state.second) == "frame");
    CHECK(state.axis == Vec3(0, 0, 1));
    CHECK((state.point - Vec3(0.505, 0, 0)).norm() < 1e-14);
    CHECK_FALSE(scene.world.may_collide(state.first, *state.second));
    REQUIRE(scene.world.advance(0.1).ok());
    CHECK(joints.state(joints.all()[0]).speed > 0);
}

TEST_CASE("joints of unknown objects, or invalid joints, are refused with their place in the file", "[unit]") {
    const TemporaryFolder folder;
    const auto refused = [&](const std::string& keys, const std::string& message) {
        CHECK_THROWS_WITH(load_scene(folder.write("joint.json", jointed_scene(keys))), Catch::Contains(message));
    };
    refused(R"("kind": "ball", "first": "dor")", "joints[0].first: found \"dor\"");
    refused(R"("kind": "bal", "first": "door")", "joints[0].kind");
    refused(R"("first": "door")", "kind");
    refused(R"("kind": "ball", "first": "door", "upper": 1)", "joints[0]");
    refused(R"("kind": "hinge", "first": "door", "motor": {"strength": 1})", "joints[0].motor");
    refused(R"("kind": "ball", "first": "door", "motor": {"strength": 1, "keys": [{"time": 0, "speed": 1}]})",
            "joints[0]");
    refused(R"("kind": "hinge", "first": "door", "motor": {"strength": 1, "keys": [{"time": 0}]})",
            "joints[0].motor.keys[0]");
    refused(R"("kind": "hinge", "first": "door",
               "motor": {"strength": 1, "keys": [{"time": 1, "speed": 1}, {"time": 0, "speed": 1}]})",
            "motor.keys[1].time: found 0 s, expected a time after that of the key before, 1 s");
    refused(R"("kind": "hinge", "first": "door", "name": "a"}, {"kind": "hinge", "first": "frame", "name": "a")",
            "joints[1].name: found \"a\", which is already the name of a joint");
}

TEST_CASE("a start and limits that contradict a mimic are named", "[unit]") {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& keys) {
        return folder.write("mimic.json", jointed_scene(R"("name": "leader", "kind": "hinge", "first": "door",
            "upper": 0.2}, {"name": "follower", "kind": "slider", "first": "frame", )" +
                                                        keys));
    };
    const std::string mimic = R"("mimic": {"joint": "leader", "ratio": -2, "offset": 1})";
    CHECK(plan_scene(file(mimic + R"(, "coordinate": 1)")).notes.empty());
    const std::vector<std::string> notes = plan_scene(file(mimic + R"(, "coordinate": 0.5)")).notes;
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Catch::Contains("joint \"follower\" starts at the coordinate 0.5, and by its mimic of "
                                         "\"leader\" it should start at 1.0"));
    CHECK_THROWS_WITH(load_scene(file(mimic + R"(, "coordinate": 1, "upper": 0.5)")),
                      Catch::Contains("joint \"follower\": joints[1].mimic: found limits") &&
                          Catch::Contains("at least 0.6 and at most 0.5"));
}

TEST_CASE("motors of a scene have keys, and probes name joints", "[unit]") {
    const TemporaryFolder folder;
    const std::string joint = R"("name": "hinge", "kind": "hinge", "first": "door",
        "motor": {"strength": 1e9, "keys": [{"time": 0, "position": 0}, {"time": 0.2, "position": 0.4}]}}],
        "settings": {"gravity": [0, 0, 0]}, "probes": [{"name": "door", "quantity": "joint", )";
    const auto file = [&](const std::string& probe) {
        std::string text = jointed_scene(joint + probe);
        return folder.write("joint.json", text);
    };
    Scene scene = load_scene(file(R"("joint": "hinge")"));
    Recorder recorder(scene.world, scene.recorded);
    std::vector<std::string> headings;
    for (const SeriesColumn& column : recorder.columns()) headings.push_back(column.heading());
    CHECK(headings == std::vector<std::string>{"time [s]", "door.force_x [N]", "door.force_y [N]", "door.force_z [N]",
                                               "door.moment_x [N m]", "door.moment_y [N m]", "door.moment_z [N m]",
                                               "door.angle [rad]", "door.speed [rad/s]", "door.motor_moment [N m]",
                                               "door.passive_moment [N m]", "door.limit_moment [N m]"});
    REQUIRE(scene.world.advance(0.1).ok());
    recorder.sample(scene.world);
    const JointState state = Joints(scene.world).state(Joints(scene.world).all()[0]);
    CHECK(state.coordinate == Approx(0.2).epsilon(1e-3));
    const std::span<const Real> row = recorder.row(0);
    CHECK(Vec3(row[1], row[2], row[3]) == state.force);
    CHECK(Vec3(row[4], row[5], row[6]) == state.moment);
    CHECK(row[7] == state.coordinate);
    CHECK(row[8] == state.speed);
    CHECK(row[9] == state.motor);
    CHECK(row[10] == state.passive);
    CHECK(row[11] == state.limit);
    CHECK_THROWS_WITH(load_scene(file(R"("joint": "hige")")),
                      Catch::Contains("probes[0].joint: found \"hige\"") && Catch::Contains("hinge"));
    CHECK_THROWS_WITH(load_scene(file(R"("joint": 3)")), Catch::Contains("probes[0].joint"));
    CHECK_THROWS_WITH(load_scene(file(R"("joint": "hinge", "body": "door")")), Catch::Contains("probes[0].body"));
}

TEST_CASE("probes name ties", "[unit]") {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& tie, const std::string& probe) {
        return folder.write("tied.json", R"({"materials": {"soft": {}}, "settings": {"gravity": [0, 0, -10]},
            "bodies": [{"name": "pad", "material": "soft",
                        "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}}],
            "ties": [{"name": "glue", "body": "pad", "nodes": [0, 1]}, {"body": "pad", "nodes": [2])" +
                                             tie + R"(}], "probes": [{"name": "p", "quantity": "tie", )" + probe +
                                             "}]}");
    };
    Scene scene = load_scene(file("", R"("tie": "tie_1")"));
    Recorder recorder(scene.world, scene.recorded);
    std::vector<std::string> headings;
    for (const SeriesColumn& column : recorder.columns()) headings.push_back(column.heading());
    CHECK(headings == std::vector<std::string>{"time [s]", "p.force_x [N]", "p.force_y [N]", "p.force_z [N]",
                                               "p.moment_x [N m]", "p.moment_y [N m]", "p.moment_z [N m]",
                                               "p.error [m]", "p.broken [1]"});
    REQUIRE(scene.world.advance(0.001).ok());
    recorder.sample(scene.world);
    const TieState state = Ties(scene.world).state(Ties(scene.world).all()[1]);
    const std::span<const Real> row = recorder.row(0);
    CHECK(state.force.norm() > 0);
    CHECK(Vec3(row[1], row[2], row[3]) == state.force);
    CHECK(Vec3(row[4], row[5], row[6]) == state.moment);
    CHECK(row[7] == state.error);
    CHECK_THROWS_WITH(load_scene(file("", R"("tie": "glu")")),
                      Catch::Contains("probes[0].tie: found \"glu\"") && Catch::Contains("glue"));
    CHECK_THROWS_WITH(load_scene(file("", R"("joint": "glue")")), Catch::Contains("\"tie\""));
    CHECK_THROWS_WITH(load_scene(file(R"(, "name": "glue")", R"("tie": "glue")")),
                      Catch::Contains("ties[1].name: found \"glue\""));
    CHECK_THROWS_WITH(load_scene(file(R"(, "name": "snap", "break_force": -1)", R"("tie": "glue")")),
                      Catch::Contains("tie \"snap\": ties[1].break_force"));
}

TEST_CASE("a body with a shape in the place of a mesh is a sphere", "[unit]") {
    const TemporaryFolder folder;
    const auto scene = [&](const std::string& body) {
        return folder.write("s.json",
                            R"({"materials": {"steel": {}}, "bodies": [{"material": "steel", )" + body + "}]}");
    };
    const std::string sphere = R"("shape": {"sphere": {"radius": 0.2}})";
    const ScenePlan plan = plan_scene(scene(sphere + R"(, "dynamics": "rigid", "positions": [[0, 0, 1], [0, 0, 2]])"));
    REQUIRE(plan.bodies.size() == 2);
    REQUIRE(plan.bodies[1].shape.sphere);
    CHECK(plan.bodies[1].shape.sphere->radius == 0.2);
    const Scene built = build_scene(plan);
    const BodyHandle body = built.world.bodies()[1];
    CHECK(built.world.mass(body) == Approx(4 * 3.14159265358979 / 3 * 0.008 * 1000).epsilon(1e-12));
    CHECK(built.world.positions(body)[0] == Vec3(0, 0, 2));

    using Catch::Contains;
    const Scene chosen = build_scene(plan_scene(scene(sphere)));
    CHECK(chosen.world.dynamics(chosen.world.bodies()[0]) == BodyDynamics::rigid);
    CHECK_THROWS_WITH(build_scene(plan_scene(scene(sphere + R"(, "dynamics": "explicit")"))),
                      Contains("dynamics") && Contains("rigid"));
    CHECK_THROWS_WITH(plan_scene(scene(R"("dynamics": "rigid")")), Contains("mesh") && Contains("shape"));
    CHECK_THROWS_WITH(plan_scene(scene(sphere + R"(, "mesh": {"ball": {"radius": 1, "resolution": 3}})")),
                      Contains("mesh") && Contains("shape"));
}

TEST_CASE("the dynamics of a body in a scene do not depend on the order of the bodies", "[unit]") {
    const TemporaryFolder folder;
    const std::string stiff = R"({"mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [4, 4, 4]}}, "name": "stiff",
        "material": "firm", "position": [0, 0, 2]})",
                      soft = R"({"mesh": {"box": {"size": [0.03, 0.03, 0.03], "cells": [4, 4, 4]}}, "name": "soft",
        "material": "rubber"})";
    const auto dynamics = [&](const std::string& bodies) {
        const Scene scene = build_scene(plan_scene(folder.write(
            "s.json", R"({"materials": {"firm": {"E": 1e8}, "rubber": {"E": 1e5}}, "bodies": [)" + bodies + "]}")));
        CHECK(!scene.world.settings().step_size);
        std::map<std::string, BodyDynamics> found;
        for (const BodyHandle body : scene.world.bodies()) found[scene.world.name(body)] = scene.world.dynamics(body);
        return found;
    };
    using Found = std::map<std::string, BodyDynamics>;
    CHECK(dynamics(stiff) == Found{{"stiff", BodyDynamics::implicit_elastic}});
    // Beside a soft body that needs short steps, implicit steps of the stiff body save little.
    const Found both{{"stiff", BodyDynamics::explicit_elastic}, {"soft", BodyDynamics::explicit_elastic}};
    CHECK(dynamics(soft + ", " + stiff) == both);
    CHECK(dynamics(stiff + ", " + soft) == both);
}

}  // namespace skerry::test::scene_plan_test
