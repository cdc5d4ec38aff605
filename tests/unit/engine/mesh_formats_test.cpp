// Elements of second order in all formats, and files of Abaqus and Medit.
#include <catch2/catch.hpp>
#include <functional>

#include "engine/mesh/tetrahedron.h"
#include "mesh_samples.h"
#include "skerry/error.h"
#include "skerry/visual.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::mesh_formats_test {

using Catch::Matchers::Contains;
using Numbers = std::vector<Index>;

namespace {

/// Corners 1 to 4 of a tetrahedron, then the middles of the edges 12, 23, 31, 14, 24 and 34. The diagonal between the
/// nodes 6 and 8 is the shortest.
const std::vector<Vec3> second_order_nodes{{0, 0, 0},     {1, 0, 0},   {0, 1, 0},       {1, 1, 1},     {0.5, 0, 0},
                                           {0.5, 0.5, 0}, {0, 0.5, 0}, {0.5, 0.5, 0.5}, {1, 0.5, 0.5}, {0.5, 1, 0.5}};

/// Lines with the ten nodes. `before` and `behind`: the text around the coordinates of a node.
std::string node_lines(const std::function<std::string(std::size_t)>& before, const char* between, const char* behind) {
    std::string lines;
    for (std::size_t n = 0; n < second_order_nodes.size(); ++n) {
        const Vec3& x = second_order_nodes[n];
        lines += before(n) + std::to_string(x[0]) + between + std::to_string(x[1]) + between + std::to_string(x[2]) +
                 behind + '\n';
    }
    return lines;
}

std::string numbered(std::size_t n) {
    return std::to_string(n + 1) + ' ';
}

/// A tetrahedron of second order with the label 7, and its face 1 2 3 in the set `face`.
struct SecondOrderFile {
    const char* name;
    std::string content;
    std::string face;
};

std::vector<SecondOrderFile> second_order_files() {
    const auto nothing = [](std::size_t) { return std::string(); };
    const std::string gmsh_nodes = node_lines(numbered, " ", ""), plain = node_lines(nothing, " ", "");
    const std::string gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n" + gmsh_nodes +
                             "$EndNodes\n$Elements\n2\n1 9 2 4 1 1 2 3 5 6 7\n2 11 2 7 1 1 2 3 4 5 6 7 8 10 9\n"
                             "$EndElements\n";
    const std::string vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" +
                            plain + "CELLS 2 18\n6 0 1 2 4 5 6\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 2\n22 24\n" +
                            "CELL_DATA 2\nSCALARS region int\nLOOKUP_TABLE default\n0 7\n" +
                            "SCALARS part int\nLOOKUP_TABLE default\n1 0\n";
    const std::string medit = "MeshVersionFormatted 2 Dimension 3 Vertices 10\n" + node_lines(nothing, " ", " 0") +
                              "TrianglesP2\n1\n1 2 3 5 6 7 4\nTetrahedraP2\n1\n1 2 3 4 5 6 7 8 9 10 7\nEnd\n";
    std::string sections;  // seven materials, the last of which is that of the tetrahedron
    for (int label = 1; label <= 7; ++label)
        sections += "*SOLID SECTION, ELSET=" + std::string(label < 7 ? "NONE" : "ALL") + ", MATERIAL=M" +
                    std::to_string(label) + "\n";
    const auto comma = [](std::size_t n) { return std::to_string(n + 1) + ", "; };
    const std::string abaqus =
        "*NODE\n" + node_lines(comma, ", ", "") +
        "*ELEMENT, TYPE=C3D10M, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6,\n7, 8, 9, 10\n*ELSET, ELSET=NONE, INTERNAL\n" +
        sections + "*SURFACE, NAME=BASE\nALL, S1\n";
    return {{"a.msh", gmsh, "surface_4"},
            {"a.vtk", vtk, "part"},
            {"b.vtk", replaced(vtk, "22 24", "69 71"), "part"},
            {"a.mesh", medit, "face_ref_4"},
            {"a.inp", abaqus, "BASE"}};
}

/// Volumes of the tetrahedra, times six.
std::vector<Real> six_volumes_of(const Mesh& mesh) {
    std::vector<Real> volumes;
    for (const std::array<Index, 4>& t : mesh.tetrahedra) volumes.push_back(mesh::six_volumes(mesh, t));
    return volumes;
}

void check_parts(const Mesh& mesh, const std::string& face) {
    CHECK(mesh.nodes.size() == 10);
    REQUIRE(mesh.tetrahedra.size() == 8);
    for (const Real volume : six_volumes_of(mesh)) CHECK(volume == Approx(1.0 / 8));
    CHECK(mesh.label == std::vector<int>(8, 7));
    CHECK(std::ranges::count_if(mesh.tetrahedra, [](const std::array<Index, 4>& t) {
              return std::ranges::count(t, 5) + std::ranges::count(t, 7) == 2;
          }) == 4);  // around the shortest diagonal
    REQUIRE(mesh.sets.contains(face));
    CHECK(mesh::nodes_of(mesh.sets.at(face), mesh.tetrahedra) == Numbers{0, 1, 2, 4, 5, 6});
    CHECK(mesh.sets.at(face).faces.size() == 4);
}

}  // namespace

TEST_CASE("a tetrahedron of second order becomes eight of equal volume with its label and sets in every format",
          "[unit]") {
    const TemporaryFolder folder;
    for (const SecondOrderFile& file : second_order_files()) {
        INFO(file.name);
        std::vector<std::string> notes;
        const Mesh mesh = mesh::read(folder.write(file.name, file.content), &notes);
        check_parts(mesh, file.face);
        CHECK_THAT(notes.back(), Contains("1 tetrahedra of second order were divided into eight linear ones each"));
    }
    // TetGen lists the middles of the edges 34, 14, 12, 23, 24 and 13.
    folder.write("a.node", "10 3 0 0\n" + node_lines(numbered, " ", ""));
    folder.write("a.face", "1 1\n1 1 2 3 6 7 5 4\n");
    check_parts(mesh::read(folder.write("a.ele", "1 10 1\n1 1 2 3 4 10 8 5 6 9 7 7\n")), "face_marker_4");
}

TEST_CASE("a mesh of second order keeps its volume and boundary, and linear tetrahedra stay whole", "[unit]") {
    const Mesh box = mesh::box({1, 2, 3}, {2, 2, 2});
    std::map<std::array<Index, 2>, Index> middle;
    std::vector<Vec3> nodes = box.nodes;
    std::string rows;
    for (const std::array<Index, 4>& t : box.tetrahedra) {
        for (const Index n : t) rows += std::to_string(n + 1) + ' ';
        for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) {
            const auto [low, high] = std::minmax(t[static_cast<std::size_t>(a)], t[static_cast<std::size_t>(b)]);
            const auto [place, added] = middle.try_emplace({low, high}, static_cast<Index>(nodes.size()));
            if (added)
                nodes.push_back((box.nodes[static_cast<std::size_t>(low)] + box.nodes[static_cast<std::size_t>(high)]) /
                                2);
            rows += std::to_string(place->second + 1) + ' ';
        }
        rows += "0\n";
    }
    const std::size_t last = nodes.size();
    nodes.insert(nodes.end(), {Vec3(9, 0, 0), Vec3(10, 0, 0), Vec3(9, 1, 0), Vec3(9, 0, 1)});
    std::string file = "MeshVersionFormatted 2\nDimension 3\nVertices " + std::to_string(nodes.size()) + '\n';
    for (const Vec3& x : nodes)
        file += std::to_string(x[0]) + ' ' + std::to_string(x[1]) + ' ' + std::to_string(x[2]) + " 0\n";
    file += "Tetrahedra 1";
    for (std::size_t n = 1; n <= 4; ++n) file += ' ' + std::to_string(last + n);
    file += " 0\nTetrahedraP2 " + std::to_string(box.tetrahedra.size()) + '\n' + rows + "End\n";
    const TemporaryFolder folder;
    const MeshReport report = inspect(mesh::read(folder.write("a.mesh", file)));
    CHECK(report.tetrahedra == 8 * box.tetrahedra.size() + 1);
    CHECK(report.boundary_triangles == 4 * mesh::boundary(box).triangles.size() + 4);
    CHECK(report.closed_manifold);
    CHECK(report.inverted + report.flat == 0);
    CHECK(report.volume == Approx(6 + 1.0 / 6));
}

TEST_CASE("a surface of second order becomes four triangles for each", "[unit]") {
    const TemporaryFolder folder;
    const std::string file =
        "MeshVersionFormatted 2 Dimension 3 Vertices 6\n0 0 0 0 2 0 0 0 0 2 0 0\n1 0 0.1 0 1 1 0.1 0 "
        "0 1 0.1 0\nTrianglesP2 1 1 2 3 4 5 6 0 End";
    std::vector<std::string> notes;
    CHECK(mesh::read_surface(folder.write("a.mesh", file), &notes).triangles ==
          std::vector<std::array<Index, 3>>{{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}});
    CHECK_THAT(notes.back(), Contains("1 triangles of second order were divided"));
}

TEST_CASE("triangles of a surface file that use a node twice are dropped with a note", "[unit]") {
    const TemporaryFolder folder;
    const std::string obj = folder
                                .write("part.obj",
                                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\n"
                                       "f 1/1 1/1 2/2\nusemtl blue\nf 1/1 2/2 3/3 3/3\n")
                                .string();
    const std::string ply = folder
                                .write("part.ply",
                                       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                       "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                                       "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 0 1\n4 0 1 2 2\n")
                                .string();
    for (const std::string& file : {obj, ply}) {
        std::vector<std::string> notes;
        CHECK(mesh::read_surface(file, &notes).triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}});
        REQUIRE(notes.size() == 1);
        CHECK_THAT(notes.front(), Catch::Contains("2 triangles use the same node twice"));
    }
    const VisualSurface visual = mesh::read_visual(obj);
    CHECK(visual.triangles.size() == 1);
    CHECK(visual.texture_corners == std::vector<std::array<Index, 3>>{{0, 1, 2}});
    CHECK(visual.material == std::vector<Index>{1});
}

TEST_CASE("a bad Medit file is refused with the place and the reason", "[unit]") {
    const std::string good =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 3\n1 0 0 3\n0 1 0 0\n0 0 1 0\n"
        "Tetrahedra\n1\n1 2 3 4 5\nHexahedra 1\n1 2 3 4 1 2 3 4 0\nUnknown 1 2.5\nEnd\nbehind the end\n";
    const TemporaryFolder folder;
    std::vector<std::string> notes;
    const Mesh mesh = mesh::read(folder.write("a.mesh", good), &notes);
    CHECK(mesh.label == std::vector<int>{5});
    CHECK(mesh.sets.at("node_ref_3").nodes == Numbers{0, 1});
    CHECK_THAT(notes.at(0), Contains("a.mesh: 1 hexahedra were left out"));
    const auto refused = [&](const std::string& from, const std::string& to, const std::string& message) {
        CHECK_THAT(refusal_of_mesh("a.mesh", replaced(good, from, to)), Contains(message));
    };
    refused("1 2 3 4 5\n", "1 2 3 5 5\n", "Tetrahedra, row 1 of 1, line 11: node: found 5, expected 1 to 4");
    refused("1 2 3 4 5\n", "1 2 3 3 5\n", "the same node twice");
    refused("1 0 0 3", "inf 0 0 3", "Vertices, row 2 of 4, line 6: position: found an infinite");
    refused("Vertices\n4", "Vertices\n3", "found \"0\", expected a keyword");
    refused("Vertices\n4", "Vertices\n5", "Vertices, row 5 of 5, line 9: position: found \"Tetrahedra\"");
    refused("Vertices\n4", "Vertices\n4000", "count: found 4000, expected at most");
    refused("Tetrahedra\n1", "Tetrahedra\n-1", "count: found -1, expected a count >= 0");
    refused("Dimension 3", "Dimension 2", "Dimension, line 2: dimension: found 2, expected 3");
    refused("MeshVersionFormatted", "MeshVersion", "expected MeshVersionFormatted");
    refused("Unknown 1 2.5", "Vertices 1 0 0 0 0", "a second section Vertices");
    refused(
        "Hexahedra 1\n1 2 3 4 1 2 3 4 0", "TetrahedraP3 1\n1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4 0",
        "TetrahedraP3, line 12: found 1 tetrahedra of third or higher order, expected tetrahedra of first or second");
    refused("Hexahedra 1\n1 2 3 4 1 2 3 4 0", "TetrahedraP2Ordering 1 0 2 0 0",
            "TetrahedraP2Ordering, row 1 of 1, line 12: coordinate: found 0, expected 2");
    const std::string binary = medit_file(mesh, 3, Bytes::native);
    CHECK_THAT(refusal_of_mesh("a.meshb", replaced(binary, std::string("\3\0\0\0", 4), std::string("\7\0\0\0", 4))),
               Contains("byte 4: version: found 7, expected 1 to 4"));
    CHECK_THAT(refusal_of_mesh("a.meshb", binary.substr(0, 90)), Contains("count: found 5, expected at most"));
    CHECK((mesh::read(folder.write("1.meshb", medit_file(mesh, 1, Bytes::foreign))).nodes[1] - mesh.nodes[1]).norm() ==
          0);
}

namespace {

const char* const deck = R"(*Heading
 a comment line of the title
*Part, name=Bar
*NODE, NSET=Nodes
1, 0., 0., 0.
2, 1., ,
3, 0., 1.
4, 0., 0., 1.
5, 1., 1., 1.
*Element, type=C3D4
1, 1, 2, 3,
 4
2, 2, 5, 3, 4,
*Element, type=S3, elset=Skin
3, 1, 2, 3
*Element, type=C3D8R
9, 1,2,3,4,5,1,2,3
*Nset, nset=Ends, generate
1, 5, 2
*Elset, elset=All
1, 2
*Elset, elset=Ends
2
*Nset, nset=All, elset=ALL
*Elset, elset=_Top_S2, internal
1
*Surface, type=ELEMENT, name=Top
_TOP_S2, S2
2, s2
*Surface, name=Outside
All
*Solid Section, elset=All, material="soft rubber"
*End Part
*Assembly, name=A
*Instance, name=left, part=BAR
*End Instance
*Instance, name=right, part=Bar
10., 0., 0.
10., 0., 0., 10., 0., 1., 90.
*End Instance
*Nset, nset=fixed, instance=right
1, 2
*Nset, nset=fixed
left.1
*Elset, elset=both
left.all, right.2
*Surface, type=NODE, name=tips
fixed
*End Assembly
*Material, name="soft rubber"
*Elastic
1e9, 0.3
)";

}  // namespace

TEST_CASE("instances of an Abaqus part are moved and keep their sets under their names", "[unit]") {
    const TemporaryFolder folder;
    std::vector<std::string> notes;
    const Mesh mesh = mesh::read(folder.write("a.inp", deck), &notes);
    REQUIRE(mesh.nodes.size() == 10);
    CHECK(mesh.tetrahedra == std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {1, 4, 2, 3}, {5, 6, 7, 8}, {6, 9, 7, 8}});
    CHECK(mesh.nodes[2] == Vec3(0, 1, 0));
    // right: the translation first, then a quarter turn around the vertical axis through (10, 0, 0)
    CHECK((mesh.nodes[6] - Vec3(10, 1, 0)).norm() < 1e-12);
    CHECK((mesh.nodes[7] - Vec3(9, 0, 0)).norm() < 1e-12);
    CHECK(mesh.label == std::vector<int>(4, 1));
    CHECK_THAT(notes.at(0), Contains("labels are numbers of materials") && Contains("1 is \"soft rubber\""));
    CHECK_THAT(notes.at(1), Contains("2 hexahedra were left out"));
    std::vector<std::string> names;
    for (const auto& [name, set] : mesh.sets) names.push_back(name);
    CHECK(names == std::vector<std::string>{"both", "fixed", "left.All", "left.Ends", "left.Ends_elements",
                                            "left.Nodes", "left.Outside", "left.Skin", "left.Top", "right.All",
                                            "right.Ends", "right.Ends_elements", "right.Nodes", "right.Outside",
                                            "right.Skin", "right.Top", "tips"});
    CHECK(mesh.sets.at("fixed").nodes == Numbers{0, 5, 6});
    CHECK(mesh.sets.at("tips").nodes == Numbers{0, 5, 6});
    CHECK(mesh.sets.at("both").tetrahedra == Numbers{0, 1, 3});
    CHECK(mesh.sets.at("left.Ends").nodes == Numbers{0, 2, 4});
    CHECK(mesh.sets.at("left.Ends_elements").tetrahedra == Numbers{1});
    CHECK(mesh.sets.at("right.All").tetrahedra == Numbers{2, 3});
    CHECK(mesh.sets.at("right.All").nodes.empty());  // the same as the nodes of the elements
    const auto sorted_faces = [&](const char* name) {
        std::vector<std::array<Index, 3>> faces = mesh.sets.at(name).faces;
        for (std::array<Index, 3>& face : faces) std::ranges::sort(face);
        return faces;
    };
    CHECK(sorted_faces("left.Skin") == std::vector<std::array<Index, 3>>{{0, 1, 2}});
    CHECK(sorted_faces("right.Top") == std::vector<std::array<Index, 3>>{{5, 6, 8}, {6, 8, 9}});
    CHECK(mesh.sets.at("left.Outside").faces.size() == 6);
}

TEST_CASE("a part without instance stands for one, and a file without parts has plain names", "[unit]") {
    const TemporaryFolder folder;
    const std::string part = std::string(deck).substr(0, std::string(deck).find("*Assembly"));
    const Mesh one = mesh::read(folder.write("a.inp", part));
    CHECK(one.tetrahedra.size() == 2);
    CHECK(one.sets.contains("Bar.Top"));
    const Mesh flat =
        mesh::read(folder.write("b.inp", replaced(replaced(part, "*Part, name=Bar\n", ""), "*End Part\n", "")));
    CHECK(flat.sets.contains("Top"));
    CHECK(flat.tetrahedra == one.tetrahedra);
}

TEST_CASE("a bad Abaqus file is refused with the place and the reason", "[unit]") {
    const auto refused = [](const std::string& from, const std::string& to, const std::string& message) {
        CHECK_THAT(refusal_of_mesh("a.inp", replaced(deck, from, to)), Contains(message));
    };
    refused("2, 2, 5, 3, 4,", "2, 2, 6, 3, 4,", "*ELEMENT, line 13: node: found 6, expected the number of a node");
    refused("2, 2, 5, 3, 4,", "2, 2, 5, 3, 3,", "the same node twice");
    refused("2, 2, 5, 3, 4,", "2, 2, 5, 3", "*ELEMENT, line 13: found 4 numbers, expected 5 numbers");
    refused("2, 2, 5, 3, 4,", "1, 2, 5, 3, 4,", "number: found 1, the number of an earlier element");
    refused("5, 1., 1., 1.", "4, 1., 1., 1.", "*NODE, line 9: number: found 4, the number of an earlier node");
    refused("5, 1., 1., 1.", "5, 1., nan, 1.", "*NODE, line 9: position: found nan");
    refused("1, 5, 2", "1, 5000000000, 2", "expected first number, last number and step of at most 5 numbers");
    refused("1, 5, 2", "1, 5, 0", "*NSET, line 19: found \"1, 5, 0\"");
    refused("1, 5, 2", "1, 5, 3, 4", "found 4 numbers, expected first number, last number and step");
    refused("_TOP_S2, S2", "_Top_S3, S2", "found \"_Top_S3\", expected a number, or the name of a set");
    refused("_TOP_S2, S2", "_Top_S2, S5", "*SURFACE, line 28: face: found \"S5\", expected S1, S2, S3 or S4");
    refused("nset=Ends", "nset", "*NSET, line 18: NSET: found no value, expected a name");
    refused("part=BAR", "part=Rod", "*INSTANCE, line 35: PART: found \"Rod\", expected the name of a part");
    refused("instance=right", "instance=middle", "INSTANCE: found \"middle\", expected the name of an instance");
    refused("10., 0., 0.\n", "10., 0.\n", "*INSTANCE, line 38: found 2 numbers, expected 3 numbers of a translation");
    refused("10., 0., 1., 90.", "10., 0., 0., 90.", "motion: found the same point twice");
    refused("name=right", "name=left", "*INSTANCE, line 37: NAME: found a second instance \"left.\"");
    refused("*Heading", "*Include, input=mesh.inp", "*INCLUDE, line 1: found the keyword *INCLUDE");
    refused("*NODE,", "*Node, input=nodes.txt,", "*NODE, line 4: found the parameter INPUT");
    refused("*NODE,", "*Node, system=C,", "SYSTEM: found \"C\", expected R");
    CHECK_THAT(refusal_of_mesh("a.inp", "[TITLE]\n"), Contains("line 1: found \"[TITLE]\", expected a keyword line"));
    CHECK_THAT(refusal_of_mesh("a.inp", ""), Contains("found no nodes"));
    CHECK_THAT(refusal_of_mesh("a.inp", "*PART, NAME=A\n*END PART\n*PART, NAME=A\n*END PART\n"),
               Contains("found no nodes"));
}

}  // namespace skerry::test::mesh_formats_test
