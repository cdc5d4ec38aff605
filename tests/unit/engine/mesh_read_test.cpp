#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "mesh_samples.h"
#include "skerry/error.h"
#include "skerry/visual.h"

namespace skerry::test::mesh_read_test {

using Catch::Matchers::Contains;

namespace {

/// Two cells: 12 tetrahedra, 12 nodes.
Mesh sample() {
    return mesh::box({0.1, 0.2, 0.3}, {1, 1, 2});
}

/// The mesh of sample() with labels that formats preserve, one of them negative.
Mesh labelled_sample() {
    Mesh mesh = sample();
    mesh.label = {1, 1, 1, 1, 1, -3, -3, 20, 20, 20, 20, 20};
    return mesh;
}

Mesh one_tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
}

bool is_surface_file(const std::string& name) {
    return name.ends_with(".obj") || name.ends_with(".ply") || name.ends_with(".stl");
}

/// Folder with meshes of other programs, which this project cannot distribute: `meshes` inside the folder named by the
/// environment variable SKERRY_TEST_DATA; nothing if that is not set.
std::optional<std::filesystem::path> meshes_of_others() {
    const char* folder = std::getenv("SKERRY_TEST_DATA");
    if (folder == nullptr) return std::nullopt;
    return std::filesystem::path(folder) / "meshes";
}

}  // namespace

TEST_CASE("every format gives back the tetrahedra that were written, without the unused node", "[unit]") {
    const Mesh mesh = sample();
    const TemporaryFolder folder;
    for (const SampleFile& file : all_sample_files(mesh)) {
        INFO(file.name);
        const std::string path = folder.write(file.name, file.content);
        if (is_surface_file(file.name) || file.name.ends_with(".node")) continue;
        const Mesh found = mesh::read(path);
        CHECK(found.tetrahedra == mesh.tetrahedra);
        REQUIRE(found.nodes.size() == mesh.nodes.size());
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) CHECK(found.nodes[n] == mesh.nodes[n]);
    }
}

TEST_CASE("in every format, nodes have the numbers that they have in the file when unused nodes are dropped",
          "[unit]") {
    const Mesh used = sample();
    CHECK(used.file_number.empty());
    // Unused nodes at the beginning and in the middle: the numbers 0 and 4.
    Mesh written = used;
    std::vector<Index> numbers;
    for (std::size_t n = 0; n < used.nodes.size(); ++n) numbers.push_back(static_cast<Index>(n < 3 ? n + 1 : n + 2));
    for (auto& tetrahedron : written.tetrahedra)
        for (Index& n : tetrahedron) n = numbers[static_cast<std::size_t>(n)];
    written.nodes.insert(written.nodes.begin() + 3, Vec3(5, 5, 5));
    written.nodes.insert(written.nodes.begin(), Vec3(7, 7, 7));
    const TemporaryFolder folder;
    for (const SampleFile& file : all_sample_files(written)) {
        INFO(file.name);
        const std::string path = folder.write(file.name, file.content);
        if (is_surface_file(file.name) || file.name.ends_with(".node")) continue;
        const Mesh found = mesh::read(path);
        CHECK(found.file_number == numbers);
        CHECK(found.nodes == used.nodes);
        CHECK(found.tetrahedra == used.tetrahedra);
    }
    const std::string whole = folder.write("whole.msh", "");
    mesh::write(whole, used);
    CHECK(mesh::read(whole).file_number.empty());
}

TEST_CASE("every format of tetrahedra gives back the labels that were written", "[unit]") {
    const Mesh mesh = labelled_sample();
    const TemporaryFolder folder;
    for (const SampleFile& file : all_sample_files(mesh)) {
        INFO(file.name);
        const std::string path = folder.write(file.name, file.content);
        if (is_surface_file(file.name) || file.name.ends_with(".node")) continue;
        std::vector<int> expected = mesh.label;
        if (file.name.ends_with(".msh"))  // in this format the sign of a group is an orientation
            for (int& label : expected) label = std::abs(label);
        if (file.name.ends_with(".inp"))  // numbers of the materials M-3, M1 and M20 in their order in the file
            for (int& label : expected) label = label == -3 ? 1 : label == 1 ? 2 : 3;
        CHECK(mesh::read(path).label == expected);
    }
}

TEST_CASE("labels are left out where a file has no whole numbers that are known to be some", "[unit]") {
    const Mesh mesh = labelled_sample();
    const TemporaryFolder folder;
    const auto labels = [&](const std::string& name, const std::string& content) {
        return mesh::read(folder.write(name, content)).label;
    };
    const std::string vtk = vtk_file(mesh, false, false), binary = vtk_file(mesh, true, true);
    CHECK(labels("a.vtk", vtk_file(sample(), false, false)).empty());
    CHECK(labels("a.vtk", replaced(vtk, "SCALARS region int", "SCALARS colour int")).empty());
    CHECK(labels("a.vtk", replaced(vtk, "region int 1", "CellEntityIds int")) == mesh.label);
    CHECK(labels("a.vtk", replaced(vtk, "SCALARS region int 1\nLOOKUP_TABLE default\n78", "SCALARS region int\n78")) ==
          mesh.label);
    CHECK(labels("a.vtk", replaced(vtk, "int 1\nLOOKUP_TABLE default\n78", "float 1\nLOOKUP_TABLE default\n7.5"))
              .empty());
    CHECK(labels("a.vtk", replaced(binary, "gmsh:physical", "gmsh:geometry")).empty());
    // An unknown entry ends the search for labels; the mesh is still accepted.
    CHECK(labels("a.vtk", replaced(vtk, "TENSORS stress double", "SPINORS spin double")).empty());
    CHECK(labels("a.vtk", replaced(vtk, "TENSORS stress double", "TENSORS stress string")).empty());

    folder.write("a.node", node_file(mesh, 0));
    const std::string ele = ele_file(mesh, 0);
    CHECK(labels("a.ele", replaced(ele, "0.5 -3", "0.5 2.5")).empty());
    CHECK(labels("a.ele", replaced(ele, "0.5 -3", "0.5 3000000000")).empty());
    CHECK(labels("a.ele", replaced(ele, "0.5 -3", "0.5")).empty());
}

TEST_CASE("a Gmsh file without physical groups has the numbers of its volumes for labels", "[unit]") {
    Mesh mesh = sample();
    mesh.label.assign(mesh.tetrahedra.size(), 0);
    const TemporaryFolder folder;
    const auto labels = [&](const std::string& content) { return mesh::read(folder.write("a.msh", content)).label; };
    const std::vector<int> volume(mesh.tetrahedra.size(), 6);
    CHECK(labels(gmsh1_file(mesh)) == volume);
    CHECK(labels(gmsh2_file(mesh, Bytes::text)) == volume);
    CHECK(labels(gmsh2_file(mesh, Bytes::foreign)) == volume);
    mesh.label.clear();  // without a section of entities
    CHECK(labels(gmsh41_file(mesh, Bytes::text)) == std::vector<int>(mesh.tetrahedra.size(), 10));
    // Some tetrahedra are in a group; the others get label 0.
    mesh.label.assign(mesh.tetrahedra.size(), 0);
    mesh.label.back() = 4;
    CHECK(labels(gmsh2_file(mesh, Bytes::text)) == mesh.label);
}

TEST_CASE("entities and cell data that do not add up are refused with the place and the reason", "[unit]") {
    const std::string gmsh = gmsh41_file(labelled_sample(), Bytes::text);
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(gmsh, "2 1 79 ", "1 1 79 ")),
               Contains("$Entities, volume 1 of 3") && Contains("tag: found \"0.25\", expected an integer"));
    CHECK_THAT(
        refusal_of_mesh("a.msh", replaced(gmsh, "1 1 1 3 \n", "1 1 1 4 \n")),
        Contains("$Entities, volume 4 of 4") && Contains("the section has fewer rows than its header announces"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(gmsh, "1 1 1 3 \n", "1 1 1 2 \n")), Contains("expected $EndEntities"));
    const std::string vtk = vtk_file(labelled_sample(), false, false);
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(vtk, "CELL_DATA 13", "CELL_DATA 12")),
               Contains("CELL_DATA") && Contains("count: found 12, expected 13, the number of cells"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(vtk, "default\n78 ", "default\n78 x ")),
               Contains("SCALARS, cell 2 of 13") && Contains("found \"x\""));
}

TEST_CASE("every format gives the boundary as a surface", "[unit]") {
    const Mesh mesh = sample();
    const SurfaceMesh boundary = mesh::boundary(mesh);
    const TemporaryFolder folder;
    for (const SampleFile& file : all_sample_files(mesh)) {
        INFO(file.name);
        const std::string path = folder.write(file.name, file.content);
        if (file.name.ends_with(".node")) continue;
        const SurfaceMesh surface = mesh::read_surface(path);
        CHECK(surface.nodes.size() == boundary.nodes.size());
        REQUIRE(surface.triangles.size() == boundary.triangles.size());
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            for (std::size_t a = 0; a < 3; ++a) {  // STL renumbers nodes; binary STL has single precision
                const Vec3& x = surface.nodes[static_cast<std::size_t>(surface.triangles[t][a])];
                CHECK((x - boundary.nodes[static_cast<std::size_t>(boundary.triangles[t][a])]).norm() < 1e-7);
            }
    }
}

TEST_CASE("either name of a TetGen pair reads both", "[unit]") {
    const TemporaryFolder folder;
    const std::string nodes = folder.write("m.node", node_file(sample(), 0)),
                      elements = folder.write("m.ele", ele_file(sample(), 0));
    CHECK(mesh::read(nodes).tetrahedra == sample().tetrahedra);
    CHECK(mesh::read(elements).tetrahedra == sample().tetrahedra);
}

TEST_CASE("inverted tetrahedra of a file are turned, and a note counts them", "[unit]") {
    const TemporaryFolder folder;
    std::vector<std::string> notes;
    const auto read = [&](const Mesh& mesh) {
        notes.clear();
        return mesh::read(folder.write("a.msh", gmsh2_file(mesh, Bytes::text)), &notes);
    };
    CHECK(inspect(read(sample())).volume == Approx(0.006));
    CHECK(notes.empty());
    Mesh some = sample(), all = sample();
    std::swap(some.tetrahedra[3][0], some.tetrahedra[3][1]);
    for (auto& t : all.tetrahedra) std::swap(t[0], t[1]);
    const std::string count = std::to_string(all.tetrahedra.size());
    for (const auto& [mesh, turned] : {std::pair(some, std::string("1")), {all, count}}) {
        const MeshReport report = inspect(read(mesh));
        CHECK(report.inverted == 0);
        CHECK(report.volume == Approx(0.006));
        REQUIRE(notes.size() == 1);
        CHECK_THAT(notes[0], Contains("a.msh: " + turned + " of " + count + " tetrahedra list their nodes"));
    }
    mesh::read_surface(folder.write("b.msh", gmsh2_file(some, Bytes::text)), &notes);
    CHECK_THAT(notes.back(), Contains("b.msh: 1 of " + count));
}

TEST_CASE("inverted tetrahedra of a mesh from elsewhere are turned, and wrong ones are refused", "[unit]") {
    std::vector<std::string> notes;
    Mesh mesh = sample();
    std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
    mesh::turn_inverted(mesh, "made", &notes);
    CHECK(inspect(mesh).inverted == 0);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Contains("made: 1 of "));
    mesh.tetrahedra[3][0] = 1000;
    CHECK_THROWS_WITH(mesh::turn_inverted(mesh, "made"), Contains("made: tetrahedron 3: node: found 1000"));
}

TEST_CASE("a file with a node in a wrong place is read as it is", "[unit]") {
    Mesh mesh{.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, 0.5)},
              .tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}}};  // turned, the second would lie in the first
    const TemporaryFolder folder;
    std::vector<std::string> notes;
    const Mesh found = mesh::read(folder.write("a.msh", gmsh2_file(mesh, Bytes::text)), &notes);
    CHECK(found.tetrahedra == mesh.tetrahedra);
    CHECK(inspect(found).inverted == 1);
    CHECK(notes.empty());
}

TEST_CASE("a bad Gmsh file is refused with the place and the reason", "[unit]") {
    const std::string good = gmsh2_file(one_tetrahedron(), Bytes::text),
                      new_good = gmsh41_file(one_tetrahedron(), Bytes::text);
    const std::string element = "2 4 2 1 6 1 2 3 4";
    CHECK(refusal_of_mesh("a.msh", good) == "nothing refused");
    CHECK(refusal_of_mesh("a.msh", new_good) == "nothing refused");
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, element, "2 4 2 1 6 1 2 3 5")),
               Contains("$Elements, element 2 of 2, line 20: node: found 5, expected the number of a node"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, element, "2 4 2 1 6 1 2 3 3")), Contains("the same node twice"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, element, "2 4 2 1 6 1 2 3")),
               Contains("found 8 numbers, expected 9"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, element, "2 29 2 1 1 1 2 3 4 1 2 3 4 1 2")),
               Contains("third or higher order"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, element, "2 77 2 1 1 1 2 3 4")), Contains("type: found 77"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2 1 0 0", "1 1 0 0")),
               Contains("$Nodes, node 2 of 5") && Contains("1, the number of an earlier node"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2 1 0 0", "2 nan 0 0")),
               Contains("position: found nan, expected a finite number"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2 1 0 0", "2 1e999 0 0")),
               Contains("found an infinite or too large number"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2 1 0 0", "2 1,0 0 0")),
               Contains("found \"1,0\", expected a number"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2 1 0 0\n", "")),
               Contains("node 5 of 5") && Contains("fewer rows"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "$Nodes\n5", "$Nodes\n4")), Contains("expected $EndNodes"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "$Nodes\n5", "$Nodes\n-5")), Contains("found -5"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "$Nodes\n5", "$Nodes\n500000000")),
               Contains("count: found 500000000, expected at most"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2.2 0 8", "3 0 8")), Contains("version: found \"3\""));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "2.2 0 8", "2.2 7 8")), Contains("file type: found 7"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(new_good, "2 5 1 999", "2 5 1 1000")),
               Contains("node numbers 1 to 1000, expected 1 to 999"));
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(new_good, "2 5 1 999", "2 6 1 999")),
               Contains("6 in the header of the section, expected 5"));
    CHECK_THAT(refusal_of_mesh("a.msh", "hello"), Contains("$MeshFormat or $NOD"));
    CHECK_THAT(refusal_of_mesh("a.msh", ""), Contains("the end of the file"));
}

TEST_CASE("a binary Gmsh file with a wrong byte order mark or a cut end is refused", "[unit]") {
    const std::string good = gmsh2_file(one_tetrahedron(), Bytes::native);
    CHECK_THAT(refusal_of_mesh("a.msh", replaced(good, "\x01\0\0\0", "\x02")), Contains("byte order"));
    CHECK_THAT(refusal_of_mesh("a.msh", good.substr(0, good.size() - 20)), Contains("the end of the file"));
}

TEST_CASE("a bad VTK file is refused with the place and the reason", "[unit]") {
    const std::string good = vtk_file(one_tetrahedron(), false, false),
                      new_good = vtk_file(one_tetrahedron(), true, false);
    CHECK(refusal_of_mesh("a.vtk", good) == "nothing refused");
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "4 0 1 2 3", "4 0 1 2 9")),
               Contains("CELLS, cell 2 of 2") && Contains("node: found 9"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "4 0 1 2 3", "3 0 1 2")),
               Contains("size: found 9 in the header, expected 8"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "5 10", "5 24")),
               Contains("node count: found 4, expected 10 for a tetrahedron of second order"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "CELL_TYPES 2", "CELL_TYPES 1")),
               Contains("count: found 1, expected 2, the number of cells"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "POINTS 5", "POINTS 6")),
               Contains("point 6 of 6") && Contains("METADATA"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "double\n0 0 0", "double\n0 x 0")), Contains("found \"x\""));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(new_good, "0 3 7", "0 8 7")), Contains("offset: found 8"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "ASCII", "ascii art")), Contains("expected ASCII or BINARY"));
    CHECK_THAT(refusal_of_mesh("a.vtk", replaced(good, "UNSTRUCTURED_GRID", "STRUCTURED_POINTS")),
               Contains("UNSTRUCTURED_GRID or POLYDATA"));
}

TEST_CASE("a bad TetGen file is refused with the place and the reason", "[unit]") {
    const auto refused = [](const std::string& nodes, const std::string& elements) {
        const TemporaryFolder folder;
        folder.write("a.node", nodes);
        try {
            mesh::read(folder.write("a.ele", elements));
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string("nothing refused");
    };
    const Mesh mesh = one_tetrahedron();
    const std::string nodes = node_file(mesh, 1), elements = ele_file(mesh, 1);
    CHECK(refused(nodes, elements) == "nothing refused");
    CHECK_THAT(refused(nodes, ele_file(mesh, 0)),
               Contains("a.ele: tetrahedra, tetrahedron 1 of 1, line 2: node: found 0"));
    CHECK_THAT(refused(nodes, replaced(elements, "1 4 2", "1 10 2")), Contains("found 7 numbers, expected 11 to 13"));
    CHECK_THAT(refused(nodes, replaced(elements, "1 4 2", "2 4 2")), Contains("end of the file"));
    CHECK_THAT(refused(nodes, elements + "2 1 2 3 4 0.5 7\n"), Contains("more tetrahedra than its header announces"));
    CHECK_THAT(refused(replaced(nodes, "2 1 0 0", "1 1 0 0"), elements), Contains("1, the number of an earlier node"));
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(mesh::read(folder.write("lonely.node", nodes)), Contains("lonely.ele: found no such file"));
}

TEST_CASE("quadrilaterals of an .obj become two triangles, and wrong corners are refused", "[unit]") {
    const TemporaryFolder folder;
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    CHECK(mesh::read_surface(folder.write("a.obj", square + "f 1 2 3 4\n")).triangles ==
          std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}});
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("b.obj", square + "f 1 2 5\n")),
                      Contains("line 5: node: found 5, expected 1 to 4"));
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("c.obj", square + "f 1 2 0\n")), Contains("node: found 0"));
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("d.obj", square)), Contains("no triangles"));
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("f.obj", "f 1 2 3\n" + square)),
                      Contains("line 1: node: found 1, expected a node defined above, but there is none"));
    CHECK_THROWS_WITH(
        mesh::read(folder.write("e.obj", square)),
        Contains(
            "found the extension .obj, expected the extension .msh, .inp, .mesh, .meshb, .vtk, .vtu, .node or .ele"));
}

TEST_CASE("polygons of a PLY file become triangles, and a bad file is refused with the place and the reason",
          "[unit]") {
    const std::string square =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    const TemporaryFolder folder;
    CHECK(mesh::read_surface(folder.write("a.ply", square)).triangles ==
          std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}});
    const auto refused = [&](const std::string& from, const std::string& to, const std::string& message) {
        CHECK_THROWS_WITH(mesh::read_surface(folder.write("b.ply", replaced(square, from, to))), Contains(message));
    };
    refused("4 0 1 2 3", "4 0 1 2 4",
            "b.ply: face, row 1 of 1, line 14: node: found 4, expected the index of a vertex, 0 to 3");
    refused("4 0 1 2 3", "2 0 1", "node count: found 2, expected at least 3");
    refused("4 0 1 2 3", "200000000 0 1 2 3", "entries: found 200000000, expected at most");
    refused("1 1 0", "1 nan 0", "vertex, row 3 of 4, line 12: position: found nan");
    refused("ascii", "binary", "format: found \"binary\", expected ascii, binary_little_endian");
    refused("vertex 4", "vertex 400000", "count: found 400000, expected at most");
    refused("property float z\n", "", "vertex: found no property z");
    refused("property float z\n", "property half z\n", "type: found \"half\"");
    refused("element vertex", "element point", "found no element vertex");
    refused("element vertex 4\n", "", "line 3: found \"property float x\", expected format NAME 1.0");
}

TEST_CASE("a PLY file gives the texture coordinates of its vertices to a visual surface", "[unit]") {
    const TemporaryFolder folder;
    const VisualSurface visual = mesh::read_visual(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
        "0 0 0 0 0.25\n1 0 0 1 0.25\n1 1 0 0.5 1\n3 2 1 0\n"));
    CHECK(visual.texture_points == std::vector<std::array<Real, 2>>{{0, 0.25}, {1, 0.25}, {0.5, 1}});
    CHECK(visual.texture_corners == std::vector<std::array<Index, 3>>{{2, 1, 0}});
    CHECK(visual.triangles == visual.texture_corners);
}

TEST_CASE("polygons of a VTK file become triangles, its lines are passed over", "[unit]") {
    const std::string head =
        "# vtk DataFile Version 3.0\nsquare\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0\n0 1 0\n";
    const TemporaryFolder folder;
    const SurfaceMesh surface =
        mesh::read_surface(folder.write("a.vtk", head + "LINES 1 3\n2 0 1\nPOLYGONS 2 9\n4 0 1 2 3\n3 0 1 2\n"));
    CHECK(surface.triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}});
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("b.vtk", head + "POLYGONS 1 3\n2 0 1\n")),
                      Contains("polygon 1 of 1") && Contains("at least 3"));
}

TEST_CASE("equal corners of an STL are one node, and triangles without three are dropped", "[unit]") {
    const std::string file =
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 1 0 -0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    const TemporaryFolder folder;
    const SurfaceMesh surface = mesh::read_surface(folder.write("a.stl", file));
    CHECK(surface.nodes.size() == 3);
    CHECK(surface.triangles.size() == 1);
}

TEST_CASE("an STL file that is empty, flat or of another kind is refused, and the error names the fault", "[unit]") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("a.stl", "")), Contains("found an empty file"));
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("b.stl", "garbage")),
                      Contains("found 7 bytes that do not begin with \"solid\", expected an STL file"));
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("c.stl", "solid s\nendsolid s\n")),
                      Contains("found no triangles, expected at least one triangle"));
    const std::string flat =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 0 0\nendloop\nendfacet\n";
    CHECK_THROWS_WITH(mesh::read_surface(folder.write("d.stl", "solid s\n" + flat + "endsolid s\n")),
                      Contains("found no triangles") && Contains("1 flat triangles"));
}

TEST_CASE("a file that is not there, or is a folder, is refused", "[unit]") {
    CHECK_THROWS_WITH(mesh::read("/nowhere/at/all.msh"), Contains("/nowhere/at/all.msh: found no such file"));
    const TemporaryFolder folder;
    const std::filesystem::path inner = folder.path() / "x.msh";
    std::filesystem::create_directory(inner);
    CHECK_THROWS_WITH(mesh::read(inner), Contains("found a folder or device"));
}

TEST_CASE("meshes of other programs load, and errors of malformed ones name the fault", "[unit]") {
    const std::optional<std::filesystem::path> given = meshes_of_others();
    if (!given) return;
    const std::filesystem::path& folder = *given;
    struct Known {
        const char* name;
        std::size_t nodes, tetrahedra;
    };
    for (const Known& known : {Known{"cube_41_ascii.msh", 14, 24},
                               {"cube_41_binary.msh", 14, 24},
                               {"liver.msh", 181, 596},
                               {"msh4_cube.msh", 14, 24},
                               {"shark_22_ascii.msh", 425, 1070},
                               {"shark_22_binary.msh", 429, 1073},
                               {"torus_low_res.msh", 264, 862},
                               {"truthcylinder1.msh", 642, 2524},
                               {"teddy.vtk", 410, 1207},
                               {"torus.vtk", 115, 286},
                               {"armadillo_4k.ele", 1180, 3717}}) {
        INFO(known.name);
        const MeshReport report = inspect(mesh::read((folder / known.name).string()));
        CHECK(report.nodes == known.nodes);
        CHECK(report.tetrahedra == known.tetrahedra);
        CHECK(report.inverted + report.flat == 0);
    }
    std::vector<std::string> notes;
    CHECK(inspect(mesh::read((folder / "six_tetra_bad.msh").string(), &notes)).inverted == 0);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Contains("six_tetra_bad.msh: 1 of 6 tetrahedra"));
    const auto refused = [&](const char* name) {
        try {
            mesh::read((folder / "malformed" / (std::string("malformed_cube_") + name + ".msh")).string());
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string("nothing refused");
    };
    CHECK_THAT(refused("22_ascii_missing_element"), Contains("element 24 of 24") && Contains("fewer rows"));
    CHECK_THAT(refused("41_ascii_mismatch_between_max_nodes_and_nodes_in_block"),
               Contains("node numbers 1 to 100, expected 1 to 14"));
    CHECK_THAT(refused("41_ascii_missing_element_header"), Contains("$Elements, line 41: header"));
    CHECK_THAT(refused("41_ascii_missing_node"), Contains("position of node 14 of 14") && Contains("$EndNodes"));
}

}  // namespace skerry::test::mesh_read_test
