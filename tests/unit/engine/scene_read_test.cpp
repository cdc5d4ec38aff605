// Reading scene files: accepted keys, and for each kind of mistake a message that names the place.
#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "engine/base/complaint.h"
#include "engine/scene/parse_json.h"
#include "engine/scene/scene_file.h"
#include "skerry/scene.h"
#include "tests/unit/engine/scene_files.h"

namespace skerry::test::scene_read_test {

namespace {

/// Error message from reading a scene; empty if it is accepted.
std::string complaint_about(const std::string& text) {
    const TemporaryFolder folder;
    const auto file = folder.write("scene.json", text);
    try {
        read_scene_file(file);
    } catch (const SceneError& error) {
        std::string message = error.what();
        REQUIRE(message.rfind(file.string(), 0) == 0);  // names the file first
        return message.substr(file.string().size());
    }
    return {};
}

struct Mistake {
    std::string name, text;
    std::vector<std::string> said;
};

void check_messages(const std::vector<Mistake>& mistakes) {
    for (const Mistake& mistake : mistakes) {
        INFO(mistake.name << ": " << mistake.text);
        const std::string message = complaint_about(mistake.text);
        INFO("message: " << message);
        REQUIRE_FALSE(message.empty());
        for (const std::string& part : mistake.said) CHECK_THAT(message, Catch::Contains(part));
    }
}

}  // namespace

TEST_CASE("text that is not JSON is refused with its line and column", "[unit]") {
    check_messages({
        {"missing brace", "{\n  \"name\": \"a\",\n  \"seconds\": 2\n", {"line 4, column 1", "not valid JSON"}},
        {"missing comma", "{\n  \"name\": \"a\"\n  \"seconds\": 2}", {"line 3, column", "not valid JSON"}},
        {"trailing comma", "{\"name\": \"a\",}", {"line 1, column 14", "not valid JSON"}},
        {"comment", "{\n// a comment\n}", {"line 2", "JSON has no comments"}},
        {"NaN", "{\"seconds\": NaN}", {"line 1, column", "JSON has no NaN"}},
        {"infinity",
         "{\"seconds\": 1e999}",
         {"seconds: found the number 1e999", "expected a number within the range of double precision"}},
        {"infinity in a list",
         R"({"bodies": [{}, {"position": [0, 1e999, 0]}]})",
         {"bodies[1].position[1]: found the number 1e999"}},
        {"bad UTF-8", "{\"name\": \"\xff\"}", {"line 1", "not valid JSON"}},
        {"two documents", "{} {}", {"line 1, column 4", "not valid JSON"}},
        {"empty", "", {"found an empty file"}},
        {"only spaces", " \n ", {"found an empty file"}},
        {"a list", "[1, 2]", {"found the list [1,2]", "expected an object"}},
        // Deep nesting must not overflow the stack: the description of a value is recursive.
        {"brackets", "{\"name\": " + std::string(100000, '[') + std::string(100000, ']') + "}", {"more than 100 deep"}},
    });
}

TEST_CASE("a key given twice is refused where it stands", "[unit]") {
    check_messages({
        {"top", R"({"name": "a", "name": "b"})", {"name\" twice", "every key at most once"}},
        {"inside", R"({"bodies": [{"name": "a"}, {"mesh": {}, "mesh": {}}]})", {"bodies[1]", "the key \"mesh\" twice"}},
        {"two names for one",
         material_with(R"("E": 1, "young_modulus": 2)"),
         {"materials.rubber", "\"young_modulus\"", "\"E\"", "they mean the same"}},
    });
}

TEST_CASE("unknown keys are named with their place and the nearest known key", "[unit]") {
    check_messages({
        {"top", scene_with(R"("colider": [])"), {"colider: found an unknown key", "did you mean \"colliders\""}},
        {"body",
         body_with(R"("postion": [0, 0, 0])"),
         {"body \"block\": bodies[0].postion: found an unknown key", "did you mean \"position\""}},
        {"swapped letters", body_with(R"("masterial": "x")"), {"bodies[0].masterial", "did you mean \"material\""}},
        {"material",
         material_with(R"("youngs_modulus": 1e5)"),
         {"materials.rubber.youngs_modulus", "did you mean \"young_modulus\""}},
        {"settings", scene_with(R"("settings": {"stepsize": 1})"), {"settings.stepsize", "did you mean \"step_size\""}},
        {"mesh",
         R"({"bodies": [{"mesh": {"bal": {}}, "material": "m"}]})",
         {"bodies[0].mesh.bal", "did you mean \"ball\""}},
        {"deep",
         scene_with(R"("colliders": [{"shape": {"sphere": {"radius": 1, "heigth": 2}}}])"),
         {"colliders[0].shape.sphere.heigth", "one of the keys \"radius\""}},
        {"a text in place of an object",
         scene_with(R"("colliders": [{"shape": "plane"}])"),
         {"colliders[0].shape: found the text \"plane\"", "expected an object with keys such as", "\"plane\""}},
    });
}

TEST_CASE("withdrawn keys and values are refused with their replacement", "[unit]") {
    check_messages({
        {"a key",
         scene_with(R"("settings": {"multirate": true})"),
         {"settings.multirate: found a key that no longer exists", "clusters", "\"implicit\" or \"automatic\""}},
        {"a key that is off", scene_with(R"("settings": {"multirate": false})"), {"delete the key"}},
        {"a value",
         scene_with(R"("settings": {"integrator": "forward_euler"})"),
         {"settings.integrator: found \"forward_euler\"", "use \"symplectic_euler\"", "\"leapfrog\""}},
    });
}

TEST_CASE("a setting that froze contacts is refused with its replacement", "[unit]") {
    check_messages({
        {"settings",
         scene_with(R"("settings": {"freeze_contacts": false})"),
         {"settings.freeze_contacts: found a key that no longer exists, expected a scene without this key",
          "delete the key"}},
    });
}

TEST_CASE("settings that are internal now are refused with their replacement", "[unit]") {
    const std::map<std::string, std::string> instead{
        {"step_safety", "step_size"},     {"max_strain_step", "step_size"},   {"restitution_speed", "restitution"},
        {"sleep_speed", "sleep_time"},    {"relaxation", "method"},           {"fixed_iterations", "max_iterations"},
        {"warm_start", "always on"},      {"contact_budgets", "always on"},   {"certify_warm_start", "always on"},
        {"skip_separating", "always on"}, {"frictionless_rows", "always on"}, {"small_regions_in_lanes", "always on"}};
    for (const auto& [key, hint] : instead)
        check_messages({{key.c_str(),
                         scene_with("\"settings\": {\"" + key + "\": 1}"),
                         {"settings." + key + ": found a key that no longer exists", "delete the key; ", hint}}});
}

TEST_CASE("a key that is near none gets no suggestion", "[unit]") {
    for (const char* key : {"pressure", "weight", "colour", "x"}) {
        CAPTURE(key);
        const std::string message = complaint_about(body_with("\"" + std::string(key) + "\": 1"));
        CHECK_THAT(message,
                   Catch::Contains("found an unknown key, expected one of") && !Catch::Contains("did you mean"));
    }
}

TEST_CASE("values of the wrong kind or out of range are refused with unit and range", "[unit]") {
    check_messages({
        {"text for a number",
         scene_with(R"("seconds": "2")"),
         {"seconds: found the text \"2\"", "expected a number above 0 [s]"}},
        {"number for text", scene_with(R"("name": 3)"), {"name: found the number 3", "expected a text"}},
        {"null", scene_with(R"("seconds": null)"), {"seconds: found null"}},
        {"two numbers for a vector",
         body_with(R"("position": [1, 2])"),
         {"bodies[0].position: found the list [1,2]", "expected a list of 3 numbers"}},
        {"text in a vector",
         body_with(R"("position": [1, 2, "x"])"),
         {"bodies[0].position[2]: found the text \"x\"", "a number [m]"}},
        {"fraction for a count",
         R"({"bodies": [{"mesh": {"ball": {"radius": 1, "resolution": 2.5}}, "material": "m"}]})",
         {"bodies[0].mesh.ball.resolution", "2.5", "whole number"}},
        {"true for a number", scene_with(R"("seconds": true)"), {"seconds: found true"}},
        {"one for true", body_with(R"("self_contact": 1)"), {"bodies[0].self_contact", "expected true or false"}},
        {"unknown choice",
         scene_with(R"("settings": {"method": "pcg_psg"})"),
         {"settings.method: found \"pcg_psg\"", "\"pgs\", \"pcg_pgs\"", "did you mean \"pcg_pgs\""}},
        {"choice that was removed",
         scene_with(R"("settings": {"method": "nncg"})"),
         {"settings.method: found \"nncg\"", "use \"automatic\" or \"ags\"", "profile_solvers"}},
        {"negative modulus",
         material_with(R"("young_modulus": -1)"),
         {"materials.rubber.young_modulus: found -1", "a number above 0 [Pa]"}},
        {"zero density", material_with(R"("rho": 0)"), {"materials.rubber.rho: found 0", "above 0 [kg/m^3]"}},
        {"incompressible", material_with(R"("nu": 0.5)"), {"materials.rubber.nu: found 0.5", "above -1 and below 0.5"}},
        {"negative friction", material_with(R"("mu": -0.1)"), {"materials.rubber.mu: found -0.1", "of at least 0"}},
        {"restitution above one",
         material_with(R"("restitution": 1.5)"),
         {"materials.rubber.restitution", "of at least 0 and of at most 1"}},
        {"dynamic above static",
         material_with(R"("static_friction": 0.3, "dynamic_friction": 0.5)"),
         {"materials.rubber.dynamic_friction", "at most the value of \"static_friction\", 0.3"}},
        {"only static",
         material_with(R"("static_friction": 0.3)"),
         {"only \"static_friction\"", "\"dynamic_friction\""}},
        {"a billion copies",
         body_with(R"("repeat": {"count": [1000, 1000, 1000], "spacing": [1, 1, 1]})"),
         {"bodies[0].repeat.count: found 1000000000 copies", "at most 1000000"}},
        {"zero axis",
         body_with(R"("rotation": {"axis": [0, 0, 0], "degrees": 3})"),
         {"bodies[0].rotation.axis", "length 0"}},
        {"two angles",
         body_with(R"("rotation": {"axis": [0, 0, 1], "degrees": 3, "radians": 1})"),
         {"bodies[0].rotation", "exactly one of"}},
        {"quaternion",
         body_with(R"("rotation": [1, 0, 0, 0])"),
         {"bodies[0].rotation: found the list [1,0,0,0]", R"(expected {"axis": [x, y, z], "degrees": angle})",
          "quaternion"}},
        {"angles about the axes",
         body_with(R"("rotation": [0, 90, 0])"),
         {"bodies[0].rotation: found the list [0,90,0]", R"({"axis": [x, y, z], "degrees": angle})", "order"}},
        {"skewed rotation",
         body_with(R"("rotation": [[1, 0, 0], [0, 1, 0.001], [0, 0, 1]])"),
         {"bodies[0].rotation", "not orthonormal", "at most 1e-6"}},
        {"reflection",
         body_with(R"("rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]])"),
         {"bodies[0].rotation", "a reflection"}},
        {"keys out of order",
         scene_with(
             R"("colliders": [{"name": "lid", "shape": {"plane": {}},
                               "motion": {"keys": [{"time": 1}, {"time": 1}]}}])"),
         {"collider \"lid\": colliders[0].motion.keys[1].time: found 1", "after"}},
        {"velocity and keys",
         scene_with(R"("colliders": [{"shape": {"plane": {}}, "motion": {"velocity": [1, 0, 0], "keys": []}}])"),
         {"colliders[0].motion", "at most one of"}},
        {"flat normal",
         scene_with(R"("colliders": [{"shape": {"plane": {"normal": [0, 0, 0]}}}])"),
         {"colliders[0].shape.plane.normal", "length 0"}},
        {"turned box",
         scene_with(R"("probes": [{"name": "p", "body": "ball", "box": {"lower": [1, 0, 0], "upper": [0, 1, 1]}}])"),
         {"probe \"p\": probes[0].box", "lower <= upper"}},
        {"a number for a material",
         body_with(R"("materials": {"-1": 5})"),
         {"bodies[0].materials.-1: found the number 5"}},
        {"a list of materials", body_with(R"("materials": ["rubber"])"), {"expected an object {NAME: VALUE, ...}"}},
    });
}

TEST_CASE("missing or repeated objects are named", "[unit]") {
    check_messages({
        {"no mesh",
         R"({"bodies": [{"name": "b", "material": "m"}]})",
         {"body \"b\": bodies[0]: found none of the keys", "exactly one of the keys \"mesh\", \"shape\""}},
        {"no material",
         R"({"bodies": [{"mesh": {"ball": {"radius": 1, "resolution": 3}}}]})",
         {"bodies[0]: found no key \"material\""}},
        {"no shape",
         R"({"bodies": [{"mesh": {}, "material": "m"}]})",
         {"bodies[0].mesh: found none of the keys", "exactly one of the keys \"box\", \"ball\""}},
        {"two shapes",
         R"({"bodies": [{"mesh": {"ball": {"radius": 1, "resolution": 3}, "file": "x"}, "material": "m"}]})",
         {"bodies[0].mesh: found the keys \"ball\", \"file\""}},
        {"no radius",
         R"({"bodies": [{"mesh": {"ball": {"resolution": 3}}, "material": "m"}]})",
         {"bodies[0].mesh.ball: found no key \"radius\""}},
        {"no body", R"({"materials": {}})", {"bodies: found no bodies, expected at least one body"}},
        {"no mesh file",
         R"({"bodies": [{"mesh": {"file": "none.msh"}, "material": "m"}]})",
         {"bodies[0].mesh.file: found the path of a missing file", "none.msh"}},
        {"a folder for a file",
         R"({"bodies": [{"mesh": {"file": "."}, "material": "m"}]})",
         {"bodies[0].mesh.file: found the path of a folder"}},
    });
}

TEST_CASE("a file that is not there, or a folder, is refused", "[unit]") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(read_scene_file(folder.path() / "none.json"), Catch::Contains("none.json: found no such file"));
    CHECK_THROWS_WITH(read_scene_file(folder.path()), Catch::Contains("found a folder"));
    CHECK_THROWS_WITH(read_scene_file("/dev/zero"), Catch::Contains("found a device"));  // a device without an end
}

TEST_CASE("short names of parameters mean the same as long ones", "[unit]") {
    const TemporaryFolder folder;
    const SceneFile scene =
        read_scene_file(folder.write("a.json", material_with(R"("E": 2e4, "nu": 0.3, "rho": 700, "mu": 0.25)")));
    const MaterialSettings& m = scene.materials.items.at(0).second;
    CHECK(m.young_modulus == 2e4);
    CHECK(m.poisson_ratio == 0.3);
    CHECK(m.density == 700);
    CHECK(m.friction == 0.25);
    CHECK(scene.name == "a");  // by default the name of the file
}

TEST_CASE("the three spellings of a rotation agree", "[unit]") {
    const TemporaryFolder folder;
    const auto rotation = [&](const std::string& text) {
        return read_scene_file(folder.write("r.json", body_with("\"rotation\": " + text))).bodies[0].rotation.value;
    };
    const Vec3 quarter = std::numbers::pi / 2 * Vec3::UnitZ();
    // The tolerance allows a handful of roundings.
    CHECK((rotation(R"({"axis": [0, 0, 2], "degrees": 90})") - quarter).norm() < 1e-14);
    CHECK((rotation(R"({"axis": [0, 0, 1], "radians": 1.5707963267948966})") - quarter).norm() < 1e-14);
    CHECK((rotation("[[0, -1, 0], [1, 0, 0], [0, 0, 1]]") - quarter).norm() < 1e-14);
    CHECK(rotation("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]").norm() == 0);
    // Half a turn: at this angle the logarithm of a rotation is ill-conditioned.
    CHECK(rotation("[[-1, 0, 0], [0, -1, 0], [0, 0, 1]]").norm() == Approx(std::numbers::pi));
}

TEST_CASE("included scenes come first and single values are replaced", "[unit]") {
    const TemporaryFolder folder;
    folder.write(
        "base.json",
        scene_with(
            R"("seconds": 5, "settings": {"threads": 3, "tolerance": 0.5}, "colliders": [{"shape": {"plane": {}}}])"));
    const SceneFile scene =
        read_scene_file(folder.write("top.json", R"({"include": "base.json", "seconds": 1, "settings": {"threads": 2},
        "bodies": [{"name": "second", "mesh": {"ball": {"radius": 1, "resolution": 3}}, "material": "rubber"}]})"));
    REQUIRE(scene.bodies.size() == 2);
    CHECK(scene.bodies[0].name == "ball");
    CHECK(scene.bodies[1].name == "second");
    CHECK(scene.colliders.size() == 1);
    CHECK(scene.seconds == 1);
    CHECK(scene.settings.threads == 2);
    CHECK(scene.settings.tolerance == 0.5);
}

TEST_CASE("mistakes of included scenes name the included file, circles are refused", "[unit]") {
    const TemporaryFolder folder;
    folder.write("base.json", R"({"bodys": []})");
    CHECK_THROWS_WITH(read_scene_file(folder.write("top.json", R"({"include": ["base.json"]})")),
                      Catch::Contains("base.json: bodys: found an unknown key"));
    folder.write("a.json", R"({"include": "b.json"})");
    folder.write("b.json", R"({"include": "a.json"})");
    CHECK_THROWS_WITH(read_scene_file(folder.path() / "a.json"),
                      Catch::Contains("b.json: include: found") && Catch::Contains("directly or through other files"));
    folder.write("same.json", scene_with(""));
    CHECK_THROWS_WITH(
        read_scene_file(folder.write("twice.json", R"({"include": "same.json", "materials": {"rubber": {}}})")),
        Catch::Contains(
            "twice.json: materials.rubber: found the name \"rubber\", which an included scene already uses"));
}

TEST_CASE("assignments change a scene on its way in", "[unit]") {
    const TemporaryFolder folder;
    const auto file = folder.write("a.json", scene_with(R"("seconds": 5)"));
    const std::vector<std::string> assignments{"bodies[0].position=[1, 2, 3]", "materials.rubber.E=3e4",
                                               "settings.threads=3",           "name=one=two",
                                               "bodies[0].name=\"round\"",     "materials[\"rubber\"].nu=0.2"};
    const SceneFile scene = read_scene_file(file, assignments);
    REQUIRE(scene.bodies.size() == 1);
    CHECK(scene.bodies[0].position == Vec3(1, 2, 3));
    CHECK(scene.bodies[0].name == "round");
    CHECK(scene.materials.items.at(0).second.young_modulus == 3e4);
    CHECK(scene.materials.items.at(0).second.poisson_ratio == 0.2);
    CHECK(scene.settings.threads == 3);
    CHECK(scene.name == "one=two");
    CHECK(scene.seconds == 5);
}

TEST_CASE("errors of assignments name the cause", "[unit]") {
    const TemporaryFolder folder;
    const auto file = folder.write("a.json", scene_with(R"("seconds": 5)"));
    const std::vector<std::pair<std::string, std::string>> mistakes{
        {"seconds", "no \"=\""},
        {"=3", "no place before"},
        {"bodies[1].position=[0,0,0]", "index 1 in a list of length 1"},
        {"bodies[x].position=[0,0,0]", "the index \"x\""},
        {"bodies[].position=[0,0,0]", "expected a whole number of at least 0"},
        {"bodies[0=1", "not closed"},
        {"bodies..x=1", "no key before \".x\""},
        {"bodies.position=1", "an object"},
        {"seconds[0]=1", "a list"},
        {"probes[0].name=x", "no value"},
        {"seconds.value=1", "an object"},
        {"second=3", "unknown key"},
        {"materials.rubbr.E=1e5",
         "found a place in the unknown material \"rubbr\", expected a place in one of the materials \"rubber\" (did "
         "you "
         "mean \"rubber\"?)"},
        {"seconds=long", "seconds: found the text \"long\""},
    };
    for (const auto& [assignment, said] : mistakes) {
        INFO(assignment);
        const std::vector<std::string> one{assignment};
        CHECK_THROWS_WITH(read_scene_file(file, one), Catch::Contains("a.json") && Catch::Contains(said));
    }
}

TEST_CASE("a scene in a text is read like a file in the given folder", "[unit]") {
    const TemporaryFolder folder;
    folder.write("materials.json", R"({"materials": {"steel": {"E": 2e11}}})");
    folder.write("mesh.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    folder.write("mesh.ele", "1 4 0\n1 1 2 3 4\n");
    const std::string text = R"({"include": "materials.json",
        "bodies": [{"name": "b", "mesh": {"file": "mesh.node"}, "material": "steel"}]})";
    const Scene scene = load_scene_text(text, folder.path());
    const Scene of_file = load_scene(folder.write("scene.json", text));
    CHECK(scene.name == "scene");
    CHECK(scene.world.state_hash() == of_file.world.state_hash());
    CHECK(load_scene_text(text, folder.path(), {.assignments = {"name=given"}}).name == "given");
    const Scene short_scene = load_scene_text(scene_with(""), folder.path(), {.step_size = 1e-5});
    CHECK(short_scene.world.settings().step_size == 1e-5);
    CHECK_THROWS_WITH(load_scene_text("", folder.path()), "scene: found an empty file, expected a scene in JSON");
    CHECK_THROWS_WITH(load_scene_text(scene_with(R"("colour": 1)"), folder.path()),
                      Catch::StartsWith("scene: colour: found an unknown key"));
    CHECK_THROWS_WITH(load_scene_text(R"({"include": "none.json"})", folder.path()),
                      Catch::StartsWith("scene: include: ") && Catch::Contains((folder.path() / "none.json").string()));
    CHECK_THROWS_WITH(load_scene_text(R"({"materials": {}})", folder.path()),
                      Catch::StartsWith("scene: bodies: found"));
}

namespace {

/// Parts of the error from building a scene out of a text.
Complaint parts_about(const std::string& text) {
    try {
        load_scene_text(text, {});
    } catch (const SceneError& error) {
        return error.complaint();
    }
    return {};
}

}  // namespace

TEST_CASE("an error carries the parts of its message", "[unit]") {
    const Complaint unknown = parts_about(scene_with(R"("colider": [])"));
    CHECK(unknown.file == "scene");
    CHECK(unknown.field == "colider");
    CHECK(unknown.found == "an unknown key");
    CHECK_THAT(unknown.expected, Catch::StartsWith("one of"));
    CHECK(unknown.hint == "did you mean \"colliders\"?");
    const Complaint no_json = parts_about("{\n\"name\" 3}");
    CHECK(no_json.file == "scene");
    CHECK_THAT(no_json.object, Catch::StartsWith("line 2, column"));
    CHECK_THAT(no_json.found, Catch::StartsWith("text that is not valid JSON"));
    // The world finds this error. The scene adds the place.
    const std::string lone = R"({"materials": {"m": {}}, "bodies": [{"name": "block", "material": "m",
        "shape": {"sphere": {"radius": 1}}, "dynamics": "explicit"}]})";
    const Complaint inner = parts_about(lone);
    CHECK(inner.file == "scene");
    CHECK(inner.object == "body \"block\"");
    CHECK(inner.field == "bodies[0]: dynamics");
    CHECK_THROWS_WITH(load_scene_text(lone, {}), inner.text());  // the body is named once
    CHECK_THAT(inner.found, Catch::Contains("explicit"));
    const SceneError plain("a text");
    CHECK(plain.complaint().text().empty());
    CHECK(std::string(plain.what()) == "a text");
}

TEST_CASE("an error at a place in a scene names no object and no field twice", "[unit]") {
    const auto message = [](const std::string& object, const std::string& path, const std::string& inner,
                            const std::string& field) {
        const SceneError error(Complaint{{}, inner, field, "x", {}, {}});
        return std::string(error_at({"f", object, path, {}, {}, {}}, error).what());
    };
    CHECK(message({}, "settings", "settings", "theta") == "f: settings: theta: found x");
    CHECK(message({}, "materials.m", "material", "density") == "f: materials.m: density: found x");
    CHECK(message("joint \"j\"", "joints[1].mimic", "joint", "mimic") == "f: joint \"j\": joints[1].mimic: found x");
    CHECK(message("body \"b\"", "bodies[2]", "body 'b'", "mass") == "f: body \"b\": bodies[2]: mass: found x");
    CHECK(message("body \"b\"", "bodies[2].pin[0]", "attachment of body 'b'", "nodes") ==
          "f: body \"b\": bodies[2].pin[0]: nodes: found x");
    CHECK(message("cavity \"c\"", "cavities[0]", "cavity of body 'b'", "faces") ==
          "f: cavity \"c\": cavities[0]: faces: found x");
    // other objects
    CHECK(message("body \"b\"", "bodies[2]", "body 'bat'", "mass") ==
          "f: body \"b\": bodies[2]: body 'bat': mass: found x");
    CHECK(message({}, "bodies[2].mesh", "node 4", {}) == "f: bodies[2].mesh: node 4: found x");
    CHECK(message({}, "bodies[2].remesh", "mesh", {}) == "f: bodies[2].remesh: mesh: found x");
    CHECK(message({}, "meshing", "mesh", {}) == "f: meshing: mesh: found x");
    CHECK(message({}, {}, "mesh", "nodes") == "f: mesh: nodes: found x");
    CHECK_THROWS_WITH(load_scene_text(scene_with(R"("settings": {"tolerance": 2})"), {}),
                      Catch::StartsWith("scene: settings: tolerance: found 2"));
    const SceneError inner(Complaint{{}, "settings", "theta", "x", {}, {}});
    CHECK(error_at({"f", {}, "settings", {}, {}, {}}, inner).complaint().object == "settings");
}

TEST_CASE("the published schema is the one that this reader has", "[unit][contract]") {
    std::ifstream file(std::filesystem::path(SKERRY_SOURCE_DIR) / "docs/scene.schema.json");
    std::ostringstream text;
    text << file.rdbuf();
    INFO("renew it with: skerry schema > docs/scene.schema.json");
    CHECK(text.str() == scene_schema());
}

}  // namespace skerry::test::scene_read_test
