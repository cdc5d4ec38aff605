// Named sets that readers of mesh files find, and the kinds of numbers that follow from a set.
#include <catch2/catch.hpp>

#include "skerry/error.h"
#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::mesh_sets_test {

using Catch::Matchers::Contains;
using Faces = std::vector<std::array<Index, 3>>;

namespace {

using Numbers = std::vector<Index>;

/// Two tetrahedra 0 1 2 3 and 1 2 3 4 after an unused node, so that numbers in files differ from those in the mesh.
/// Lists a triangle of the boundary in the opposite orientation, and a triangle that is no face.
const char* const gmsh2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 7 "tip"
1 2 "edge of it"
2 3 "skin"
3 9 "core"
$EndPhysicalNames
$Nodes
6
1 9 9 9
2 0 0 0
3 1 0 0
4 0 1 0
5 0 0 1
6 1 1 1
$EndNodes
$Elements
8
1 15 2 7 1 6
2 1 2 2 1 2 3
3 2 2 3 1 2 3 4
4 2 2 3 1 2 3 6
5 2 2 5 2 3 4 6
6 4 2 9 1 2 3 4 5
7 4 2 4 2 3 4 5 6
8 15 2 8 1 1
$EndElements
)";

const char* const gmsh4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
0 7 "tip"
2 3 "skin"
3 9 "core"
$EndPhysicalNames
$Entities
1 0 1 2
5 1 1 1 1 7
6 0 0 0 1 1 1 2 3 4 0
1 0 0 0 1 1 1 2 9 12 0
2 0 0 0 1 1 1 1 12 0
$EndEntities
$Nodes
1 5 2 6
3 1 0 5
2
3
4
5
6
0 0 0
1 0 0
0 1 0
0 0 1
1 1 1
$EndNodes
$Elements
4 4 1 4
0 5 15 1
1 6
2 6 2 1
2 2 3 4
3 1 4 1
3 2 3 4 5
3 2 4 1
4 3 4 5 6
$EndElements
)";

std::string vtk_of(const std::string& data, bool binary) {
    const auto integers = [&](const std::vector<int>& numbers) {
        std::string text;
        for (const int number : numbers)
            if (binary)
                for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(number >> shift & 255);
            else
                text += std::to_string(number) + " ";
        return text + "\n";
    };
    return std::string("# vtk DataFile Version 3.0\nsets\n") + (binary ? "BINARY" : "ASCII") +
           "\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 int\n" + integers({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}) +
           "CELLS 3 14\n" + integers({4, 0, 1, 2, 3, 4, 1, 2, 3, 4, 3, 0, 1, 2}) + "CELL_TYPES 3\n" +
           integers({10, 10, 5}) + data;
}

}  // namespace

TEST_CASE("physical groups of Gmsh are sets by name, with the numbers of the mesh", "[unit]") {
    const TemporaryFolder folder;
    std::vector<std::string> notes;
    const Mesh mesh = mesh::read(folder.write("m.msh", gmsh2), &notes);
    REQUIRE(mesh.sets.size() == 5);
    CHECK(mesh.sets.at("tip") == MeshSet{.nodes = {4}});
    CHECK(mesh.sets.at("edge of it") == MeshSet{.nodes = {0, 1}});
    CHECK(mesh.sets.at("skin").faces == Faces{{0, 2, 1}});  // counter-clockwise as seen from outside
    CHECK(mesh.sets.at("core") == MeshSet{.tetrahedra = {0}});
    CHECK(mesh.sets.at("surface_5").faces.size() == 1);
    CHECK(mesh.label == std::vector<int>{9, 4});
    REQUIRE(notes.size() == 2);
    CHECK_THAT(notes[0], Contains("1 triangles are not faces of a tetrahedron"));
    CHECK_THAT(notes[1], Contains("the set \"point_8\" contains no node of a tetrahedron and was dropped"));

    const Mesh of_4 = mesh::read(folder.write("m4.msh", gmsh4));
    REQUIRE(of_4.sets.size() == 4);
    CHECK(of_4.sets.at("surface_4").faces == of_4.sets.at("skin").faces);  // a surface in two groups
    CHECK(of_4.sets.at("tip") == MeshSet{.nodes = {4}});
    CHECK(of_4.sets.at("skin").faces == Faces{{0, 2, 1}});
    CHECK(of_4.sets.at("core") == MeshSet{.tetrahedra = {0}});
    CHECK(of_4.label == std::vector<int>{9, 12});
}

TEST_CASE("a volume in two physical groups of Gmsh 4.1 belongs to both sets", "[unit]") {
    const TemporaryFolder folder;
    std::string text = gmsh4;
    text.replace(text.find("2 3 \"skin\""), 10, "3 12 \"all\"");
    const Mesh mesh = mesh::read(folder.write("m.msh", text));
    CHECK(mesh.sets.at("core").tetrahedra == Numbers{0});
    CHECK(mesh.sets.at("all").tetrahedra == Numbers{0, 1});
}

TEST_CASE("Gmsh 2.2 repeats a tetrahedron for each of its groups, and it is read once", "[unit]") {
    const TemporaryFolder folder;
    std::string text = gmsh2;
    text.replace(text.find("8\n1 15"), 2, "9\n");
    text.replace(text.find("7 4 2 4 2"), 9, "9 4 2 3 1 2 3 4 5\n7 4 2 4 2");
    text.replace(text.find("2 3 \"skin\""), 10, "3 3 \"more\"");
    const Mesh mesh = mesh::read(folder.write("m.msh", text));
    CHECK(mesh.tetrahedra.size() == 2);
    CHECK(mesh.label == std::vector<int>{9, 4});
    CHECK(mesh.sets.at("core").tetrahedra == Numbers{0});
    CHECK(mesh.sets.at("more").tetrahedra == Numbers{0});
}

TEST_CASE("arrays of whole numbers and of bits in VTK files are sets", "[unit]") {
    const TemporaryFolder folder;
    const std::string text = vtk_of(
        "CELL_DATA 3\nSCALARS inner int 1\nLOOKUP_TABLE default\n1 0 0\nFIELD f 2\nzone 1 3 int\n0 5 5\nheat 1 3 "
        "float\n1 1 0\nPOINT_DATA 5\nSCALARS held bit 1\nLOOKUP_TABLE default\n1 0 0 1 0\nFIELD f 2\nid 1 5 long\n"
        "10 11 12 13 14\nside 1 5 int\n0 2 2 -1 0\n",
        false);
    const Mesh mesh = mesh::read(folder.write("m.vtk", text));
    REQUIRE(mesh.sets.size() == 5);
    CHECK(mesh.sets.at("inner") == MeshSet{.tetrahedra = {0}});
    CHECK(mesh.sets.at("zone_5") == MeshSet{.faces = {{0, 2, 1}}, .tetrahedra = {1}});
    CHECK(mesh.sets.at("held") == MeshSet{.nodes = {0, 3}});
    CHECK(mesh.sets.at("side_2") == MeshSet{.nodes = {1, 2}});
    CHECK(mesh.sets.at("side_-1") == MeshSet{.nodes = {3}});

    const std::string bits = vtk_of(
        "POINT_DATA 5\nSCALARS held bit 1\nLOOKUP_TABLE default\n\x90\nSCALARS more bit 1\n"
        "LOOKUP_TABLE default\n\x08\n",
        true);
    const Mesh packed = mesh::read(folder.write("b.vtk", bits));
    REQUIRE(packed.sets.size() == 2);
    CHECK(packed.sets.at("held") == MeshSet{.nodes = {0, 3}});
    CHECK(packed.sets.at("more") == MeshSet{.nodes = {4}});
}

TEST_CASE("arrays of whole numbers in VTK XML files are sets", "[unit]") {
    const TemporaryFolder folder;
    const Mesh mesh = mesh::read(folder.write("m.vtu", R"(<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="5" NumberOfCells="2">
<PointData><DataArray type="UInt8" Name="held" format="ascii">1 0 0 1 0</DataArray>
<DataArray type="Float64" Name="heat" format="ascii">1 0 0 1 0</DataArray></PointData>
<CellData><DataArray type="Int32" Name="zone" format="ascii">3 3</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 1 2 3 4</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
)"));
    REQUIRE(mesh.sets.size() == 2);
    CHECK(mesh.sets.at("held") == MeshSet{.nodes = {0, 3}});
    CHECK(mesh.sets.at("zone_3") == MeshSet{.tetrahedra = {0, 1}});
}

TEST_CASE("markers of TetGen are sets of nodes and faces", "[unit]") {
    const TemporaryFolder folder;
    folder.write("m.node", "5 3 0 1\n1 0 0 0 2\n2 1 0 0 0\n3 0 1 0 2\n4 0 0 1 -1\n5 1 1 1 0\n");
    folder.write("m.face", "2 1\n1 1 2 3 6\n2 2 3 4 0\n");
    const Mesh mesh = mesh::read(folder.write("m.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n"));
    REQUIRE(mesh.sets.size() == 3);
    CHECK(mesh.sets.at("node_marker_2") == MeshSet{.nodes = {0, 2}});
    CHECK(mesh.sets.at("node_marker_-1") == MeshSet{.nodes = {3}});
    CHECK(mesh.sets.at("face_marker_6").faces == Faces{{0, 2, 1}});
}

TEST_CASE("a set of one kind gives the numbers of the other kinds", "[unit]") {
    const std::vector<std::array<Index, 4>> tetrahedra{{0, 1, 2, 3}, {1, 2, 3, 4}};
    Faces surface;
    for (const BoundaryTriangle& t : boundary_triangles(tetrahedra)) surface.push_back(t.node);
    const MeshSet upper{.tetrahedra = {1}};
    CHECK(mesh::nodes_of(upper, tetrahedra) == Numbers{1, 2, 3, 4});
    CHECK(mesh::faces_of(upper, tetrahedra, surface).size() == 3);  // without the face between the tetrahedra
    const MeshSet nodes{.nodes = {0, 1, 2, 3}};
    CHECK(mesh::faces_of(nodes, tetrahedra, surface).size() == 3);
    CHECK(mesh::tetrahedra_of(nodes, tetrahedra) == Numbers{0});
    const MeshSet both{.nodes = {4}, .faces = {{0, 2, 1}}};
    CHECK(mesh::nodes_of(both, tetrahedra) == Numbers{0, 1, 2, 4});
    CHECK(mesh::faces_of(both, tetrahedra, surface) == Faces{{0, 2, 1}});
    // listed faces, faces of listed tetrahedra and faces between listed nodes, each once
    const MeshSet three{.nodes = {0, 1, 2, 3}, .faces = {{2, 1, 0}}, .tetrahedra = {1}};
    CHECK(mesh::faces_of(three, tetrahedra, surface).size() == 6);
}

TEST_CASE("a written mesh has its sets when it is read", "[unit]") {
    const TemporaryFolder folder;
    Mesh mesh = mesh::box({1, 1, 1}, {2, 1, 1});
    mesh.label.assign(mesh.tetrahedra.size(), 3);
    mesh.sets["one corner"] = {.nodes = {0, 2}};
    mesh.sets["outside"] = {.faces = {boundary_triangles(mesh.tetrahedra).front().node}, .tetrahedra = {0, 5}};
    mesh.sets["inside"] = {.tetrahedra = {5, 6}};
    const std::string path = (folder.path() / "m.msh").string();
    mesh::write(path, mesh);
    const Mesh found = mesh::read(path);
    CHECK(found.sets == mesh.sets);
    CHECK(found.label == mesh.label);
    CHECK(found.tetrahedra == mesh.tetrahedra);
}

TEST_CASE("inspect counts the sets of a mesh", "[unit]") {
    Mesh mesh = mesh::box({1, 1, 1}, {1, 1, 1});
    mesh.sets["corner"] = {.nodes = {0, 1}, .tetrahedra = {5}};
    CHECK(inspect(mesh).sets == std::map<std::string, std::array<std::size_t, 3>>{{"corner", {2, 0, 1}}});
}

}  // namespace skerry::test::mesh_sets_test
