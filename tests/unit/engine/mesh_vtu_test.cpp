// Reader of VTK XML files (.vtu).
#include <zlib.h>

#include <catch2/catch.hpp>

#include "mesh_samples.h"

namespace skerry::test::mesh_vtu_test {

using Catch::Matchers::Contains;
using Place = VtuForm::Place;

namespace {

Mesh sample() {
    Mesh mesh = mesh::box({0.1, 0.2, 0.3}, {1, 1, 2});
    mesh.label = {1, 1, 1, 1, 1, -3, -3, 20, 20, 20, 20, 20};
    return mesh;
}

std::string by_zlib(const std::string& bytes) {
    std::string packed(compressBound(bytes.size()), '\0');
    uLongf size = packed.size();
    REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                     bytes.size()) == Z_OK);
    packed.resize(size);
    return packed;
}

void expect_sample(const Mesh& found, bool wide) {
    const Mesh mesh = sample();
    CHECK(found.tetrahedra == mesh.tetrahedra);
    CHECK(found.label == mesh.label);
    REQUIRE(found.nodes.size() == mesh.nodes.size());
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const Vec3 expected = wide ? mesh.nodes[n] : Vec3(mesh.nodes[n].cast<float>().cast<Real>());
        CHECK(found.nodes[n] == expected);
    }
}

}  // namespace

TEST_CASE("a .vtu file gives back its mesh in every encoding, number type and byte order", "[unit]") {
    const TemporaryFolder folder;
    const auto place = GENERATE(Place::ascii, Place::base64, Place::appended_raw, Place::appended_base64);
    for (const bool compressed : {false, true})
        for (const bool wide_header : {false, true})
            for (const bool wide_numbers : {false, true})
                for (const bool foreign : {false, true})
                    for (const auto pack : {static_cast<std::string (*)(const std::string&)>(nullptr), by_zlib}) {
                        const VtuForm form{place, compressed, wide_header, wide_numbers, foreign, pack};
                        INFO(static_cast<int>(place) << compressed << wide_header << wide_numbers << foreign);
                        // numbers in text keep all digits
                        expect_sample(mesh::read(folder.write("mesh.vtu", vtu_file(sample(), form))),
                                      wide_numbers || place == Place::ascii);
                    }
}

TEST_CASE("a base64 header may be padded apart from the numbers, and the pieces of a .vtu are joined", "[unit]") {
    const std::string head = "<VTKFile type='UnstructuredGrid'><UnstructuredGrid>";
    // In base64: the count of bytes, 4, then the Int32 4; and the count 1, then the UInt8 10.
    const auto piece = [](const std::string& z) {
        return "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" "
               "NumberOfComponents=\"3\">0 0 " +
               z + " 1 0 " + z + " 0 1 " + z + " 0 0 2" + z +
               "</DataArray></Points><Cells><DataArray type=\"Int8\" Name=\"connectivity\">0 1 2 3</DataArray>"
               "<DataArray type=\"Int32\" Name=\"offsets\" format=\"binary\">BAAAAA==BAAAAA==</DataArray>"
               "<DataArray type=\"UInt8\" Name=\"types\" format=\"binary\">AQAAAAo=</DataArray></Cells></Piece>";
    };
    const TemporaryFolder folder;
    const Mesh found =
        mesh::read(folder.write("mesh.vtu", head + piece("0") + piece("5") + "</UnstructuredGrid></VTKFile>"));
    CHECK(found.tetrahedra == std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {4, 5, 6, 7}});
    REQUIRE(found.nodes.size() == 8);
    CHECK(found.nodes[7] == Vec3(0, 0, 25));
    CHECK(found.label.empty());
}

TEST_CASE("a bad .vtu file is refused with the array, the field and the reason", "[unit]") {
    const Mesh mesh = sample();
    const std::string text = vtu_file(mesh, {}), raw = vtu_file(mesh, {.place = Place::appended_raw}),
                      base64 = vtu_file(mesh, {.place = Place::base64}),
                      zipped = vtu_file(mesh, {.place = Place::appended_raw, .compressed = true});
    const auto refused = [](const std::string& content, std::initializer_list<const char*> parts) {
        const std::string message = refusal_of_mesh("mesh.vtu", content);
        for (const char* part : parts) CHECK_THAT(message, Contains(part));
    };
    refused("", {"no \"<\"", "incomplete"});
    refused("<html></html>", {"<html>", "the tag \"html\"", "<VTKFile ...>"});
    refused(replaced(text, "UnstructuredGrid", "PolyData"), {"<VTKFile>, line 3", "type", "\"PolyData\""});
    refused(replaced(zipped, "vtkZLibDataCompressor", "vtkLZ4DataCompressor"), {"compressor", "zlib"});
    refused(replaced(text, "NumberOfPoints=\"13\"", "NumberOfPoints=\"14\""),
            {"<Piece> 1, <Points>, array \"Points\"", "position", "39 numbers", "42 numbers"});
    refused(replaced(raw, "NumberOfPoints=\"13\"", "NumberOfPoints=\"99999999\""),
            {"array \"Points\"", "312 bytes", "2399999976 bytes"});
    refused(replaced(zipped, "NumberOfPoints=\"13\"", "NumberOfPoints=\"99999999\""),
            {"array \"Points\"", "5 blocks of 64 bytes", "2399999976 bytes in all"});
    refused(replaced(text, "NumberOfCells=\"13\"", "NumberOfCells=\"-1\""), {"NumberOfCells", "-1", "0 to"});
    refused(replaced(text, "0 1 2 ", "0 1 13 "), {"array \"connectivity\"", "entry 3 of 51", "13", "0 to 12"});
    refused(replaced(text, "3 7 11", "3 7 6"), {"array \"offsets\", cell 3 of 13", "offset", "6", "at least 7"});
    refused(replaced(text, "Name=\"types\"", "Name=\"kinds\""), {"<Piece> 1, <Cells>", "no array \"types\""});
    refused(replaced(text, "Float64", "Real"), {"array \"Points\"", "type", "\"Real\"", "Float32, Float64"});
    refused(
        replaced(text, "<DataArray type=\"Int64\" Name=\"offsets\"", "<DataArray type=\"Float64\" Name=\"offsets\""),
        {"array \"offsets\"", "\"Float64\"", "an integer type"});
    refused(replaced(text, "9 9 9", "9 9 nan"), {"point 13 of 13", "nan", "finite"});
    refused(replaced(base64, "\"3\" format=\"binary\">\n  ", "\"3\" format=\"binary\">\n  !"), {"\"!\"", "base64"});
    refused(raw.substr(0, raw.size() - 200), {"the end of the data", "more bytes"});
    refused(base64.substr(0, base64.size() / 2), {"incomplete"});
    refused(replaced(raw, "offset=\"0\"", "offset=\"99999\""), {"nothing refused"});  // an array that is not used
    refused(replaced(raw, "Name=\"connectivity\" format=\"appended\" offset=\"",
                     "Name=\"connectivity\" format=\"appended\" offset=\"9999"),
            {"array \"connectivity\"", "offset", "the size of <AppendedData>"});
    std::string hit = zipped;
    hit[hit.size() - 100] ^= 1;
    refused(hit, {"compressed block", "zlib"});
}

TEST_CASE("information keys of an array hide none of the arrays that follow", "[unit]") {
    const TemporaryFolder folder;
    const std::string key =
        "<InformationKey name=\"a > b\" location=\"vtkDataArray\" length=\"1\">"
        "<Value index=\"0\">1</Value></InformationKey>";
    const std::string array = "<DataArray type=\"Float64\" Name=\"q\" format=\"ascii\">1 2 3" + key + "</DataArray>";
    for (const char* parent : {"<CellData>", "<Cells>"}) {
        const std::string text = replaced(vtu_file(sample(), {}), parent, parent + array);
        expect_sample(mesh::read(folder.write("keys.vtu", text)), true);
    }
}

TEST_CASE("elements that are no tetrahedra are named with their kinds", "[unit]") {
    const std::string file = vtu_file(sample(), {});
    const std::size_t types = file.find("Name=\"types\"");
    std::string kinds = file.substr(types);
    for (int i = 0; i < 2; ++i) kinds = replaced(kinds, "10 ", "12 ");
    while (kinds.find("10 ") != std::string::npos) kinds = replaced(kinds, "10 ", "13 ");
    const std::string hexahedra = file.substr(0, types) + kinds;
    CHECK_THAT(refusal_of_mesh("mesh.vtu", hexahedra),
               Contains("no tetrahedra") && Contains("1 triangles, 2 hexahedra, 10 prisms"));
    const TemporaryFolder folder;
    const std::string gmsh = folder.write(
        "mesh.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n"
        "7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n3\n1 5 0 1 2 3 4 5 6 7 8\n2 3 0 1 2 3 4\n3 3 0 5 6 7 "
        "8\n$EndElements\n");
    CHECK_THROWS_WITH(mesh::read(gmsh), Contains("0 triangles, 1 hexahedra, 2 quadrilaterals"));
    CHECK_THROWS_WITH(mesh::read_surface(gmsh), Contains("no triangles") && Contains("1 hexahedra"));
}

}  // namespace skerry::test::mesh_vtu_test
