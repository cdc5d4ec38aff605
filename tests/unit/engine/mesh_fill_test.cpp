// Filling of surfaces: exact filling by Netgen, regions, limits and failures of meshers, and the cache.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "engine/mesh/repair/surface_measures.h"
#include "skerry/error.h"
#include "skerry/fill.h"
#include "skerry/scene.h"
#include "tests/support/draws.h"
#include "tests/support/surface_corpus.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::mesh_fill_test {

namespace {

using Catch::Contains;

/// Sets an environment variable for the lifetime of the object.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
    ~Variable() { unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

private:
    const char* name_;
};

/// A program in place of a mesher.
std::filesystem::path stub(const TemporaryFolder& folder, const std::string& name, const std::string& commands) {
    const std::filesystem::path file = folder.write(name, "#!/bin/sh\n" + commands + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file;
}

/// The surface of one tetrahedron, and the commands of a mesher that fills it.
const SurfaceMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
const char* const fill_tetrahedron = "printf '4 1\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n0 1 2 3\\n' >&3";

/// Path of the program skerry-fill in the build folder of this test program.
std::string built_netgen() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "skerry-fill";
}

bool netgen_is_built() {
    const bool built = std::filesystem::exists(built_netgen());
    if (!built) WARN("skerry-fill is not built: it needs libnglib-dev");
    return built;
}

std::string failure(const SurfaceMesh& surface, const mesh::FillSettings& settings = {}) {
    try {
        mesh::fill(surface, "part.stl", settings);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no failure";
}

bool notes_contain(const mesh::FilledMesh& filled, const std::string& part) {
    return std::ranges::any_of(filled.notes,
                               [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST_CASE("a clean surface is filled with its own nodes and triangles") {
    if (!netgen_is_built()) return;
    const Variable netgen("SKERRY_FILL", built_netgen());
    const SurfaceMesh ball = moved(ball_surface(0.5), {3, 1, 2});
    const mesh::FilledMesh filled = mesh::fill(ball, "ball.stl");
    REQUIRE(filled.mesher == "Netgen");
    CHECK(filled.exact);
    REQUIRE(filled.mesh.nodes.size() >= ball.nodes.size());
    CHECK(std::equal(ball.nodes.begin(), ball.nodes.end(), filled.mesh.nodes.begin()));
    const auto rotated = [](std::array<Index, 3> t) {
        std::rotate(t.begin(), std::ranges::min_element(t), t.end());
        return t;
    };
    std::set<std::array<Index, 3>> given, found;
    for (const auto& t : ball.triangles) given.insert(rotated(t));
    for (const auto& t : mesh::boundary(filled.mesh).triangles) found.insert(rotated(t));
    CHECK(given == found);
    const Real volume = mesh::volume_inside(ball);
    CHECK(std::abs(inspect(filled.mesh).volume - volume) < 1e-12 * volume);
    CHECK(std::abs(*filled.surface_volume - volume) < 1e-12 * volume);
    CHECK(filled.distance.greatest() < 1e-14);
    CHECK(filled.stable_step > 0);
    CHECK(filled.mesh.label.empty());
}

TEST_CASE("an inner shell bounds a region with a label, or a cavity", "[processes]") {
    if (!netgen_is_built()) return;
    const Variable netgen("SKERRY_FILL", built_netgen());
    const SurfaceMesh outer = ball_surface(0.5, 6), inner = ball_surface(0.2, 4);
    const Real outer_volume = mesh::volume_inside(outer), inner_volume = mesh::volume_inside(inner);
    const auto volume_of = [](const Mesh& mesh, int label) {
        Mesh part{.nodes = mesh.nodes, .tetrahedra = {}};
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            if (mesh.label[t] == label) part.tetrahedra.push_back(mesh.tetrahedra[t]);
        return inspect(part).volume;
    };
    // The order of the shells in the file does not matter.
    const mesh::FilledMesh regions = mesh::fill(both(inner, outer), "ball.stl");
    CHECK(volume_of(regions.mesh, 1) == Approx(outer_volume - inner_volume).epsilon(1e-12));
    CHECK(volume_of(regions.mesh, 2) == Approx(inner_volume).epsilon(1e-12));
    CHECK(inspect(regions.mesh).closed_manifold);
    REQUIRE(regions.mesh.sets.size() == 2);
    CHECK(regions.mesh.sets.at("shell_1").faces.size() == outer.triangles.size());
    CHECK(regions.mesh.sets.at("shell_2").faces.size() == inner.triangles.size());
    CHECK(*regions.surface_volume == Approx(outer_volume).epsilon(1e-12));

    const mesh::FilledMesh hollow = mesh::fill(both(outer, inner), "ball.stl", {.cavities = true});
    CHECK(inspect(hollow.mesh).volume == Approx(outer_volume - inner_volume).epsilon(1e-12));
    CHECK(hollow.mesh.label.empty());
    CHECK(hollow.mesh.sets.at("shell_2").faces.size() == inner.triangles.size());
    // Clockwise triangles of an inner shell mean a cavity without the flag.
    CHECK(mesh::fill(both(outer, turned_inside_out(inner)), "ball.stl").mesh.tetrahedra == hollow.mesh.tetrahedra);
}

TEST_CASE("the shells of several files are sets with the names of the files", "[processes]") {
    if (!netgen_is_built()) return;
    const Variable netgen("SKERRY_FILL", built_netgen());
    const TemporaryFolder folder;
    const auto write = [&](const char* name, const SurfaceMesh& surface) {
        std::ofstream file(folder.path() / name);
        file.precision(17);
        for (const Vec3& x : surface.nodes) file << "v " << x.transpose() << "\n";
        for (const auto& [a, b, c] : surface.triangles) file << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << "\n";
        return folder.path() / name;
    };
    const std::vector files{write("bone.obj", ball_surface(0.2, 4)), write("skin.obj", ball_surface(0.5, 6))};
    const mesh::FilledMesh filled = mesh::fill(files);
    CHECK(filled.mesh.sets.at("bone").faces.size() == ball_surface(0.2, 4).triangles.size());
    CHECK(filled.mesh.sets.at("skin").faces.size() == ball_surface(0.5, 6).triangles.size());
    CHECK(inspect(filled.mesh).labels.size() == 2);
}

TEST_CASE("a repeated shell is filled once, with a note", "[processes]") {
    if (!netgen_is_built()) return;
    const Variable netgen("SKERRY_FILL", built_netgen());
    const SurfaceMesh ball = ball_surface(0.5);
    const mesh::FilledMesh filled = mesh::fill(both(ball, renumbered(ball)), "twice.stl");
    CHECK(inspect(filled.mesh).volume == Approx(mesh::volume_inside(ball)).epsilon(1e-12));
    CHECK(notes_contain(filled, "1 repeated shell"));
}

TEST_CASE("a mesher that hangs, crashes or writes no mesh is an error of the surface") {
    const TemporaryFolder folder;
    const SurfaceMesh open = with_hole(ball_surface(0.5, 4), {0, 0, 0.5}, 0.05);
    const auto failure_of = [&](const std::string& commands, const mesh::FillLimits& limits = {}) {
        const Variable python("SKERRY_FILL_PYTHON", stub(folder, "python", commands).string());
        return failure(open, {.limits = limits});
    };
    const std::string hung = failure_of("sleep 100", {.seconds = 0.1});
    CHECK_THAT(hung, Contains("part.stl") && Contains("time limit of 0.1 s") && Contains("larger edge"));
    CHECK_THAT(failure_of("kill -ABRT $$"), Contains("crashed: Aborted"));
    CHECK_THAT(failure_of("echo no license >&2; exit 9"), Contains("exit code 9") && Contains("no license"));
    for (const char* garbage : {"echo rubbish >&3", "printf '1 1\\n0 0 0\\n0 0 0 0\\n' >&3", "true",
                                "printf '4 1\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 nan\\n0 1 2 3\\n' >&3",
                                "printf '4 1\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n0 1 2 7\\n' >&3"})
        CHECK_THAT(failure_of(garbage), Contains("not a valid mesh"));
    CHECK_THAT(failure_of("printf '4 1\\n0 0 0\\n1 0 0\\n0 1 0\\n1 1 0\\n0 1 2 3\\n' >&3"),
               Contains("made 1 flat tetrahedra"));
    CHECK_THAT(failure_of("sleep 100", {.bytes = 1000}), Contains("more memory"));
    CHECK_THAT(failure_of("exit 3"), Contains("pip install wildmeshing"));
    const Variable python("SKERRY_FILL_PYTHON", "/nowhere/python");
    CHECK_THAT(failure(open), Contains("/nowhere/python") && Contains("pip install wildmeshing"));
    CHECK_THAT(failure(open, {.tolerance = 0}), Contains("tolerance above 0"));
    CHECK_THAT(failure(open, {.edge = -1}), Contains("edge") && Contains("-1"));
    CHECK_THAT(failure(open, {.edge = 5}), Contains("edge") && Contains("measures 1.66 across"));
    CHECK_THAT(failure(open, {.edge = 1e-4}),
               Contains("edge") && Contains("of at least") && Contains("no \"scale\" is applied"));
    CHECK_THROWS_WITH(mesh::fill(std::vector<std::filesystem::path>{}), Contains("found no files"));
}

TEST_CASE("a mesher ends with the exception of a progress function") {
    const TemporaryFolder folder;
    const Variable netgen("SKERRY_FILL", stub(folder, "fill", "sleep 100").string());
    const auto stop = [](const std::string& activity) {
        if (activity.find("Netgen") != std::string::npos) throw std::runtime_error("stopped by the user");
    };
    CHECK_THROWS_WITH(mesh::fill(tetrahedron, "part.stl", {}, stop), "stopped by the user");
}

TEST_CASE("if Netgen fails or is missing, fTetWild fills the surface, with a note") {
    const TemporaryFolder folder;
    const Variable python("SKERRY_FILL_PYTHON", stub(folder, "python", fill_tetrahedron).string());
    for (const std::string& program : {stub(folder, "fill", "kill -SEGV $$").string(), std::string("/nowhere/fill")}) {
        const Variable netgen("SKERRY_FILL", program);
        const mesh::FilledMesh filled = mesh::fill(tetrahedron, "part.stl");
        CHECK(filled.mesher == "fTetWild");
        CHECK_FALSE(filled.exact);
        CHECK(notes_contain(filled, "Netgen"));
        CHECK_THAT(failure(tetrahedron, {.tolerance = 0}), Contains("Netgen"));
    }
}

TEST_CASE("a surface of a scene is filled again only after a change of the surface or of the settings") {
    const TemporaryFolder folder;
    const Variable netgen(
        "SKERRY_FILL",
        stub(folder, "fill", "echo run >> " + (folder.path() / "runs").string() + "\n" + std::string(fill_tetrahedron))
            .string());
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    const std::filesystem::path file = folder.write("part.obj", obj);
    const auto runs_of = [&](const mesh::FillSettings& settings) {
        std::filesystem::remove(folder.path() / "runs");
        const Mesh mesh = mesh::fill_cached(file, settings);
        CHECK(mesh.tetrahedra.size() == 1);
        CHECK(mesh.label.empty());
        std::ifstream runs(folder.path() / "runs");
        return std::distance(std::istream_iterator<std::string>(runs), std::istream_iterator<std::string>());
    };
    const mesh::FillSettings exact{.tolerance = 0};
    const auto cache_of = [&] {
        for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
            if (entry.path().extension() == ".msh") return entry.path();
        return std::filesystem::path();
    };
    CHECK(runs_of(exact) > 0);
    CHECK(runs_of(exact) == 0);
    const std::filesystem::path cache = cache_of();
    CHECK_THAT(cache.filename().string(), Contains("part.obj."));
    CHECK(runs_of({.edge = 1.5, .tolerance = 0}) > 0);
    folder.write("part.obj", obj.substr(0, obj.find('f')) + "f 3 2 1\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    CHECK(runs_of(exact) > 0);
    folder.write("part.obj", "# a comment\n" + obj);
    CHECK(runs_of(exact) == 0);
    std::ofstream(cache) << "damaged";
    CHECK(runs_of(exact) > 0);
    CHECK(runs_of(exact) == 0);
    // A cache file that cannot be written is no error.
    std::filesystem::remove(cache);
    std::filesystem::create_directory(cache);
    CHECK(runs_of(exact) > 0);
    std::vector<std::string> notes;
    mesh::fill_cached(file, exact, {}, &notes);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes.front(), Contains("part.obj: the mesh could not be stored") && Contains("every run fills"));
}

TEST_CASE("notes of a filling are given again with the mesh of the cache file") {
    const TemporaryFolder folder;
    const Variable netgen("SKERRY_FILL", stub(folder, "fill", fill_tetrahedron).string());
    // The last triangle is repeated, which is noted.
    const std::filesystem::path file =
        folder.write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 4 3\n");
    std::vector<std::string> first, second;
    mesh::fill_cached(file, {}, {}, &first);
    const Variable none("SKERRY_FILL", "/nowhere/fill");
    mesh::fill_cached(file, {}, {}, &second);
    CHECK_FALSE(first.empty());
    CHECK(second == first);
}

TEST_CASE("a mesh of fTetWild is not kept if Netgen is missing or crashes") {
    const TemporaryFolder folder;
    const Variable python("SKERRY_FILL_PYTHON", stub(folder, "python", fill_tetrahedron).string());
    const std::filesystem::path file =
        folder.write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    for (const std::string& program : {stub(folder, "fill", "kill -SEGV $$").string(), std::string("/nowhere/fill")}) {
        const Variable netgen("SKERRY_FILL", program);
        std::vector<std::string> notes;
        mesh::fill_cached(file, {}, {}, &notes);
        REQUIRE(notes.size() == 2);
        CHECK_THAT(notes[0], Contains("filled by fTetWild"));
        CHECK_THAT(notes[1], Contains("the mesh was not stored"));
        for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
            CHECK(entry.path().extension() != ".msh");
    }
}

TEST_CASE("a scene fills a surface that is also the file of a rigid body, and has the notes of the filling") {
    const TemporaryFolder folder;
    const Variable netgen("SKERRY_FILL", "/nowhere/fill");
    const std::string python = stub(folder, "python", fill_tetrahedron).string();
    folder.write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    const std::string text = R"({"materials": {"rubber": {}}, "bodies": [
        {"mesh": {"file": "part.obj"}, "dynamics": "rigid", "material": "rubber"},
        {"mesh": {"surface": "part.obj"}, "material": "rubber", "position": [3, 0, 0]}]})";
    const Scene scene = load_scene_text(text, folder.path(), {.fill_python = python});
    REQUIRE(scene.world.bodies().size() == 2);
    CHECK(std::ranges::any_of(scene.notes, [](const std::string& note) { return Contains("fTetWild").match(note); }));
    const auto stop = [](const std::string&) { throw std::runtime_error("stopped by the user"); };
    CHECK_THROWS_WITH(load_scene_text(text, folder.path(), {.fill_python = python}, stop), "stopped by the user");
}

TEST_CASE("with cavities a shell close inside another one bounds a cavity, otherwise it counts as repeated") {
    const TemporaryFolder folder;
    const Variable netgen("SKERRY_FILL", "/nowhere/fill");
    // The mesher in this test writes one tetrahedron, whatever the surface.
    const std::string python = stub(folder, "python", fill_tetrahedron).string();
    SurfaceMesh wall = tetrahedron;
    const Vec3 centroid(0.25, 0.25, 0.25);
    for (const Vec3& x : tetrahedron.nodes) wall.nodes.push_back(centroid + 0.9995 * (x - centroid));
    for (const auto& [a, b, c] : tetrahedron.triangles) wall.triangles.push_back({a + 4, b + 4, c + 4});
    const mesh::FilledMesh hollow = mesh::fill(wall, "wall", {.cavities = true, .python = python});
    CHECK(hollow.surface.shells.size() == 2);
    CHECK(notes_contain(hollow, "an empty cavity"));
    const mesh::FilledMesh solid = mesh::fill(wall, "wall", {.python = python});
    CHECK(solid.surface.shells.size() == 1);
    CHECK(notes_contain(solid, "m apart"));
}

TEST_CASE("a mesher that ends leaves no process behind, and its numbers do not depend on the locale") {
    const TemporaryFolder folder;
    const std::filesystem::path left = folder.path() / "left";
    const Variable netgen("SKERRY_FILL", stub(folder, "fill",
                                              "sleep 100 & echo $! > " + left.string() + "\ncat > " +
                                                  (folder.path() / "given").string() + "\n" + fill_tetrahedron)
                                             .string());
    // Not every machine has this locale.
    const std::string before = std::setlocale(LC_NUMERIC, nullptr);
    std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
    mesh::fill(tetrahedron, "part.stl", {.edge = 1.25, .tolerance = 0});
    std::setlocale(LC_NUMERIC, before.c_str());
    pid_t process = 0;
    REQUIRE(std::ifstream(left) >> process);
    // A killed process that nobody waits for may stay in the list of processes as a zombie.
    const auto runs = [&] {
        std::string number, name, state = "Z";
        std::ifstream("/proc/" + std::to_string(process) + "/stat") >> number >> name >> state;
        return state != "Z";
    };
    for (int i = 0; runs() && i < 100; ++i) usleep(1000);
    CHECK_FALSE(runs());
    std::ifstream given(folder.path() / "given");
    CHECK(std::string(std::istreambuf_iterator<char>(given), {}).find(',') == std::string::npos);
}

TEST_CASE("a surface of two TetGen files is filled again after a change of either") {
    const TemporaryFolder folder;
    const Variable netgen("SKERRY_FILL", stub(folder, "fill", fill_tetrahedron).string());
    const std::filesystem::path file = folder.write("part.ele", "1 4 0\n1 1 2 3 4\n");
    const auto meshes_with = [&](const std::string& last_node) {
        folder.write("part.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 " + last_node + "\n");
        mesh::fill_cached(file, {.tolerance = 0});
        return std::ranges::count_if(std::filesystem::directory_iterator(folder.path()),
                                     [](const auto& entry) { return entry.path().extension() == ".msh"; });
    };
    CHECK(meshes_with("0 0 1") == 1);
    // The other position has the same volume, which the mesh of the mesher in this test fits.
    CHECK(meshes_with("0.25 0 1") == 2);
}

TEST_CASE("surfaces with the faults of users' files are filled with the volume of their solid, or refused") {
    if (!netgen_is_built()) return;
    const Variable netgen("SKERRY_FILL", built_netgen());
    // fTetWild fills the surfaces with faults if SKERRY_FILL_PYTHON names an interpreter that has it.
    std::vector<CorpusSurface> corpus = surface_corpus();
    if (!full_tests()) corpus.resize(1);
    for (const CorpusSurface& sample : corpus) {
        INFO(sample.name);
        try {
            const mesh::FilledMesh filled = mesh::fill(sample.surface, sample.name);
            const MeshReport report = inspect(filled.mesh);
            CHECK(report.inverted + report.flat == 0);
            // fTetWild moves the surface by up to the tolerance.
            const Real surface = mesh::area_of(filled.surface.cleaned);
            const Real rounding = 1e-6 * report.volume;
            if (sample.volume)
                CHECK(std::abs(report.volume - *sample.volume) <=
                      (filled.exact ? 0 : filled.tolerance * surface) + rounding);
        } catch (const SceneError& error) {
            CHECK_THAT(error.what(), Contains(sample.name));
            CHECK_FALSE(mesh::check_surface(sample.surface).can_be_filled());
        }
    }
}

}  // namespace

}  // namespace skerry::test::mesh_fill_test
