#include "mesh_samples.h"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "mesh_sample_text.h"
#include "skerry/error.h"

namespace skerry::test {
std::string gmsh1_file(const Mesh& mesh) {
    std::ostringstream out;
    out << "$NOD\n" << mesh.nodes.size() + 1 << '\n';
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) out << n + 1 << ' ' << text(mesh.nodes[n]) << '\n';
    out << "999 9 9 9\n$ENDNOD\n$ELM\n" << mesh.tetrahedra.size() + 2 << '\n';
    out << "1 15 1 1 1 1\n2 2 1 1 3 1 2 3\n";
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
        out << e + 3 << " 4 " << label_of(mesh, e) << " 6 4" << text(mesh.tetrahedra[e], 1) << '\n';
    out << "$ENDELM\n";
    return out.str();
}

std::string gmsh2_file(const Mesh& mesh, Bytes bytes) {
    const bool binary = bytes != Bytes::text, swap = bytes == Bytes::foreign;
    std::string file = binary ? "$MeshFormat\n2.2 1 8\n" : "$MeshFormat\n2.2 0 8\n";
    if (binary) put<std::int32_t>(file, 1, swap);
    if (binary) file += "\n";
    file += "$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body $1\"\n$EndPhysicalNames\n$Nodes\n" +
            std::to_string(mesh.nodes.size() + 1) + "\n";
    for (std::size_t n = 0; n <= mesh.nodes.size(); ++n) {
        const int number = n < mesh.nodes.size() ? static_cast<int>(n) + 1 : 999;
        const Vec3 x = n < mesh.nodes.size() ? mesh.nodes[n] : Vec3(9, 9, 9);
        if (binary) {
            put<std::int32_t>(file, number, swap);
            for (const Real value : x) put<double>(file, value, swap);
        } else {
            file += std::to_string(number) + ' ' + text(x) + '\n';
        }
    }
    file += "\n$EndNodes\n$Elements\n" + std::to_string(mesh.tetrahedra.size() + 1) + "\n";
    if (binary) {
        for (const int value : {2, 1, 2, 1, 1, 1, 1, 2, 3}) put<std::int32_t>(file, value, swap);
        for (const int value : {4, static_cast<int>(mesh.tetrahedra.size()), 2}) put<std::int32_t>(file, value, swap);
    } else {
        file += "1 2 2 1 1 1 2 3\n";
    }
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        if (binary) {
            for (const int value : {static_cast<int>(e) + 2, label_of(mesh, e), 6})
                put<std::int32_t>(file, value, swap);
            for (const Index n : mesh.tetrahedra[e]) put<std::int32_t>(file, n + 1, swap);
        } else {
            file += std::to_string(e + 2) + " 4 2 " + std::to_string(label_of(mesh, e)) + " 6" +
                    text(mesh.tetrahedra[e], 1) + '\n';
        }
    }
    return file + (binary ? "\n" : "") + "$EndElements\n";
}

std::string gmsh41_file(const Mesh& mesh, Bytes bytes) {
    const bool binary = bytes != Bytes::text, swap = bytes == Bytes::foreign;
    std::string file = binary ? "$MeshFormat\n4.1 1 8\n" : "$MeshFormat\n4.1 0 8\n";
    const auto ints = [&](std::initializer_list<std::int32_t> values) {
        for (const std::int32_t value : values)
            binary ? put(file, value, swap) : void(file += std::to_string(value) + ' ');
    };
    const auto sizes = [&](std::initializer_list<std::uint64_t> values) {
        for (const std::uint64_t value : values)
            binary ? put(file, value, swap) : void(file += std::to_string(value) + ' ');
    };
    const auto end_line = [&] { binary ? void() : void(file += '\n'); };
    if (binary) put<std::int32_t>(file, 1, swap);
    file += binary ? "\n$EndMeshFormat\n" : "$EndMeshFormat\n";
    // Volumes 10, 11, ... are in one group each, except the first, which is in two. Before them come a point, a curve
    // and a surface in their own groups.
    std::vector<std::uint64_t> first{0};  // first tetrahedron of each volume, then the end
    for (std::size_t e = 1; e < mesh.tetrahedra.size(); ++e)
        if (label_of(mesh, e) != label_of(mesh, e - 1)) first.push_back(e);
    first.push_back(mesh.tetrahedra.size());
    const auto places = [&](std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) binary ? put(file, 0.25, swap) : void(file += "0.25 ");
    };
    if (!mesh.label.empty()) {
        file += "$Entities\n";
        sizes({1, 1, 1, first.size() - 1}), end_line();
        ints({1}), places(3), sizes({1}), ints({77}), end_line();
        ints({1}), places(6), sizes({0}), sizes({2}), ints({1, -1}), end_line();
        ints({1}), places(6), sizes({1}), ints({78}), sizes({1}), ints({1}), end_line();
        for (std::size_t v = 0; v + 1 < first.size(); ++v) {
            ints({static_cast<std::int32_t>(10 + v)}), places(6);
            const int label = label_of(mesh, first[v]);
            v == 0 ? (sizes({2}), ints({label, 79})) : (sizes({1}), ints({label}));
            sizes({2}), ints({1, -2}), end_line();
        }
        file += binary ? "\n$EndEntities\n" : "$EndEntities\n";
    }
    file += "$Nodes\n";
    const std::uint64_t nodes = mesh.nodes.size(), tetrahedra = mesh.tetrahedra.size();
    sizes({2, nodes + 1, 1, 999});
    end_line();
    ints({3, 1, 0}), sizes({nodes}), end_line();
    for (std::uint64_t n = 0; n < nodes; ++n) sizes({n + 1}), end_line();
    for (const Vec3& x : mesh.nodes) {
        if (binary)
            for (const Real value : x) put<double>(file, value, swap);
        else
            file += text(x) + '\n';
    }
    ints({1, 2, 1}), sizes({1}), end_line();  // parametric: one more number
    sizes({999}), end_line();
    if (binary)
        for (const double value : {9.0, 9.0, 9.0, 0.5}) put(file, value, swap);
    else
        file += "9 9 9 0.5\n";
    file += binary ? "\n$EndNodes\n$Elements\n" : "$EndNodes\n$Elements\n";
    sizes({first.size(), tetrahedra + 1, 1, tetrahedra + 1}), end_line();
    ints({2, 1, 2}), sizes({1}), end_line(), sizes({1, 1, 2, 3}), end_line();
    for (std::size_t v = 0; v + 1 < first.size(); ++v) {
        ints({3, static_cast<std::int32_t>(10 + v), 4}), sizes({first[v + 1] - first[v]}), end_line();
        for (std::uint64_t e = first[v]; e < first[v + 1]; ++e) {
            sizes({e + 2});
            for (const Index n : mesh.tetrahedra[e]) sizes({static_cast<std::uint64_t>(n) + 1});
            end_line();
        }
    }
    return file + (binary ? "\n" : "") + "$EndElements\n";
}

std::string vtk_file(const Mesh& mesh, bool offsets, bool binary) {
    constexpr bool swap = std::endian::native == std::endian::little;
    const std::size_t cells = mesh.tetrahedra.size() + 1;  // tetrahedra and one triangle
    std::string file = std::string("# vtk DataFile Version ") + (offsets ? "5.1" : "3.0") + "\na title\n" +
                       (binary ? "BINARY" : "ASCII") + "\nDATASET UNSTRUCTURED_GRID\n";
    const auto reals = [&](const Vec3& x) {
        if (!binary)
            file += text(x) + '\n';
        else
            for (const Real value : x) put<double>(file, value, swap);
    };
    const auto integer = [&](std::int64_t value, bool wide) {
        if (!binary)
            file += std::to_string(value) + ' ';
        else if (wide)
            put<std::int64_t>(file, value, swap);
        else
            put<std::int32_t>(file, static_cast<std::int32_t>(value), swap);
    };
    file += "FIELD FieldData 1\nTIME 1 1 double\n";
    binary ? put<double>(file, 0.5, swap) : void(file += "0.5");
    file += "\nPOINTS " + std::to_string(mesh.nodes.size() + 1) + " double\n";
    for (const Vec3& x : mesh.nodes) reals(x);
    reals({9, 9, 9});
    file += "\nMETADATA\nINFORMATION 0\n\n";
    if (offsets) {
        file += "CELLS " + std::to_string(cells + 1) + ' ' + std::to_string(4 * cells - 1) + "\nOFFSETS vtktypeint64\n";
        integer(0, true);
        for (std::size_t c = 0; c < cells; ++c) integer(static_cast<std::int64_t>(4 * c + 3), true);
        file += "\nCONNECTIVITY vtktypeint64\n";
    } else {
        file += "CELLS " + std::to_string(cells) + ' ' + std::to_string(5 * cells - 1) + "\n";
        integer(3, false);
    }
    for (const int n : {0, 1, 2}) integer(n, offsets);
    for (const std::array<Index, 4>& t : mesh.tetrahedra) {
        if (!offsets) integer(4, false);
        for (const Index n : t) integer(n, offsets);
    }
    file += "\nCELL_TYPES " + std::to_string(cells) + "\n";
    integer(5, false);
    for (std::size_t c = 1; c < cells; ++c) integer(10, false);
    const auto real = [&](double value) {
        binary ? put(file, value, swap) : void(file += std::to_string(value) + ' ');
    };
    const std::size_t points = mesh.nodes.size() + 1;
    file += "\nPOINT_DATA " + std::to_string(points) + "\nSCALARS region double\nLOOKUP_TABLE default\n";
    for (std::size_t n = 0; n < points; ++n) real(7);
    file += "\nVECTORS force double\n";
    for (std::size_t n = 0; n < 3 * points; ++n) real(0.5);
    file += "\nCELL_DATA " + std::to_string(cells) + "\n";
    file += offsets ? "FIELD FieldData 2\nshares 2 " + std::to_string(cells) + " double\n" : "TENSORS stress double\n";
    for (std::size_t c = 0; c < (offsets ? 2 : 9) * cells; ++c) real(0.5);
    if (!mesh.label.empty()) {
        file += offsets ? "\nMETADATA\nINFORMATION 0\n\ngmsh:physical 1 " + std::to_string(cells) + " vtktypeint64\n"
                        : "\nSCALARS region int 1\nLOOKUP_TABLE default\n";
        for (std::size_t c = 0; c < cells; ++c) integer(c == 0 ? 78 : mesh.label[c - 1], offsets);
    } else if (offsets) {
        file += "\nother 1 " + std::to_string(cells) + " vtktypeint64\n";
        for (std::size_t c = 0; c < cells; ++c) integer(3, true);
    }
    return file + "\n";
}

namespace {

/// A zlib stream (RFC 1950) with one stored block.
std::string stored(const std::string& bytes) {
    std::string stream = "\x78\x01\x01";
    const auto size = static_cast<std::uint16_t>(bytes.size());
    const bool swap = std::endian::native == std::endian::big;
    put<std::uint16_t>(stream, size, swap);
    put<std::uint16_t>(stream, static_cast<std::uint16_t>(~size), swap);
    stream += bytes;
    std::uint32_t a = 1, b = 0;  // checksum Adler-32
    for (const char c : bytes) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    put<std::uint32_t>(stream, b << 16 | a, !swap);
    return stream;
}

std::string in_base64(const std::string& bytes) {
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

/// Writes the arrays of a VTK XML file.
class VtuArrays {
public:
    explicit VtuArrays(const VtuForm& form) : form_(form) {}

    /// Returns the tag of an array with its numbers, or adds the numbers to the appended data. An array of real numbers
    /// is of a floating-point type, any other of an integer type.
    std::string array(const std::string& name, const std::vector<double>& numbers, bool real, const char* more = "") {
        const std::string type = std::string(real ? "Float" : "Int") + (form_.wide_numbers ? "64" : "32");
        std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" " + more + "format=\"";
        if (form_.place == VtuForm::Place::ascii) {
            std::ostringstream text;
            text.precision(17);
            for (const double number : numbers) text << number << ' ';
            return tag + "ascii\">\n" + text.str() + "\n</DataArray>\n";
        }
        std::string bytes;
        for (const double number : numbers) {
            if (form_.wide_numbers)
                real ? put<double>(bytes, number, swap()) : put(bytes, static_cast<std::int64_t>(number), swap());
            else
                real ? put(bytes, static_cast<float>(number), swap())
                     : put(bytes, static_cast<std::int32_t>(number), swap());
        }
        const std::string data = encoded(bytes);
        if (form_.place == VtuForm::Place::base64) return tag + "binary\">\n  " + data + "\n</DataArray>\n";
        tag += "appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>\n";
        appended_ += data;
        return tag;
    }
    std::string appended() const {
        if (form_.place == VtuForm::Place::ascii || form_.place == VtuForm::Place::base64) return {};
        const bool raw = form_.place == VtuForm::Place::appended_raw;
        return std::string("<AppendedData encoding=\"") + (raw ? "raw" : "base64") + "\">\n _" + appended_ +
               "\n</AppendedData>\n";
    }

private:
    bool swap() const { return form_.foreign_bytes; }
    std::string header(const std::vector<std::size_t>& numbers) const {
        std::string bytes;
        for (const std::size_t number : numbers)
            form_.wide_header ? put<std::uint64_t>(bytes, number, swap())
                              : put(bytes, static_cast<std::uint32_t>(number), swap());
        return bytes;
    }
    std::string encoded(const std::string& bytes) const {
        const bool raw = form_.place == VtuForm::Place::appended_raw;
        if (!form_.compressed) return raw ? header({bytes.size()}) + bytes : in_base64(header({bytes.size()}) + bytes);
        constexpr std::size_t block = 64;  // size of a block, small enough for several per array [bytes]
        std::vector<std::size_t> sizes{(bytes.size() + block - 1) / block, block, bytes.size() % block};
        std::string packed;
        for (std::size_t first = 0; first < bytes.size(); first += block) {
            const std::string part = bytes.substr(first, block);
            const std::string own = form_.pack == nullptr ? stored(part) : form_.pack(part);
            sizes.push_back(own.size());
            packed += own;
        }
        return raw ? header(sizes) + packed : in_base64(header(sizes)) + in_base64(packed);
    }

    const VtuForm& form_;
    std::string appended_;
};

}  // namespace

std::string vtu_file(const Mesh& mesh, const VtuForm& form) {
    const bool little = (std::endian::native == std::endian::little) != form.foreign_bytes;
    VtuArrays arrays(form);
    std::vector<double> points, nodes{0, 1, 2}, offsets{3}, types{5}, labels{78};
    for (const Vec3& x : mesh.nodes) points.insert(points.end(), x.begin(), x.end());
    points.insert(points.end(), {9, 9, 9});
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        nodes.insert(nodes.end(), mesh.tetrahedra[e].begin(), mesh.tetrahedra[e].end());
        offsets.push_back(static_cast<double>(nodes.size()));
        types.push_back(10);
        labels.push_back(label_of(mesh, e));
    }
    std::string file = std::string("<?xml version=\"1.0\"?>\n<!-- a mesh > -->\n<VTKFile type=\"UnstructuredGrid\" ") +
                       "version=\"1.0\" byte_order=\"" + (little ? "LittleEndian" : "BigEndian") + "\"" +
                       (form.wide_header ? " header_type=\"UInt64\"" : "") +
                       (form.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") +
                       ">\n<UnstructuredGrid>\n<FieldData>\n" +
                       "<Array type=\"String\" Name=\"names\" NumberOfTuples=\"1\" format=\"ascii\">98 0</Array>\n" +
                       "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(mesh.nodes.size() + 1) +
                       "\" NumberOfCells=\"" + std::to_string(types.size()) + "\">\n";
    file += "<PointData>\n" + arrays.array("region", std::vector<double>(mesh.nodes.size() + 1, 7), false) +
            "</PointData>\n";
    if (!mesh.label.empty()) file += "<CellData>\n" + arrays.array("region", labels, false) + "</CellData>\n";
    file += "<Points>\n" + arrays.array("Points", points, true, "NumberOfComponents=\"3\" ") + "</Points>\n<Cells>\n" +
            arrays.array("connectivity", nodes, false) + arrays.array("offsets", offsets, false) +
            arrays.array("types", types, false) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    return file + arrays.appended() + "</VTKFile>\n";
}

std::string node_file(const Mesh& mesh, int first_number) {
    std::string file = "# nodes\n" + std::to_string(mesh.nodes.size() + 1) + " 3 1 1\n";
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        file += "  " + std::to_string(static_cast<int>(n) + first_number) + ' ' + text(mesh.nodes[n]) + " 0.5 1\n";
    return file + "999 9 9 9 0.5 0  # unused\n# by hand\n";
}

std::string ele_file(const Mesh& mesh, int first_number) {
    std::string file = std::to_string(mesh.tetrahedra.size()) + " 4 2\n";
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
        file += std::to_string(static_cast<int>(e) + first_number) + text(mesh.tetrahedra[e], first_number) + " 0.5 " +
                std::to_string(label_of(mesh, e)) + "\n\n";
    return file;
}

std::string obj_file(const SurfaceMesh& surface) {
    std::string file = "# a surface\no body\n";
    for (const Vec3& x : surface.nodes) file += "v " + text(x) + "\n";
    file += "vt 0.5 0.5\nvn 0 0 1\n";
    for (const std::array<Index, 3>& t : surface.triangles)
        file += "f " + std::to_string(t[0] + 1) + "//1 " + std::to_string(t[1] + 1) + "/1/1 " +
                std::to_string(t[2] - static_cast<int>(surface.nodes.size())) + "\n";
    return file;
}

std::string ply_file(const SurfaceMesh& surface, Bytes bytes) {
    const bool swap = bytes == Bytes::foreign, little = (std::endian::native == std::endian::little) != swap;
    std::string file = "ply\nformat ";
    file += bytes == Bytes::text ? "ascii" : little ? "binary_little_endian" : "binary_big_endian";
    file += " 1.0\ncomment made by hand\nelement vertex " + std::to_string(surface.nodes.size()) +
            "\nproperty double x\nproperty float64 y\nproperty float nx\nproperty double z\nproperty uchar red\n"
            "element camera 1\nproperty list ushort int16 views\nelement face " +
            std::to_string(surface.triangles.size()) +
            "\nproperty uchar group\nproperty list uchar int vertex_indices\nend_header\n";
    const auto number = [&]<class T>(T value) {
        if (bytes == Bytes::text)
            file += std::to_string(value) + ' ';
        else
            put(file, value, swap);
    };
    const auto end_row = [&] { file += bytes == Bytes::text ? "\n" : ""; };
    for (const Vec3& x : surface.nodes) {
        number(x[0]), number(x[1]), number(0.5f), number(x[2]), number(std::uint8_t{200}), end_row();
    }
    number(std::uint16_t{2}), number(std::int16_t{7}), number(std::int16_t{-8}), end_row();
    for (const std::array<Index, 3>& t : surface.triangles) {
        number(std::uint8_t{1}), number(std::uint8_t{3});
        for (const Index n : t) number(static_cast<std::int32_t>(n));
        end_row();
    }
    return file;
}

std::string stl_file(const SurfaceMesh& surface, bool binary) {
    constexpr bool swap = std::endian::native == std::endian::big;
    std::string file = binary ? "solid in name only" : "solid body\n";
    if (binary) {
        file.resize(80, ' ');
        put<std::uint32_t>(file, static_cast<std::uint32_t>(surface.triangles.size()), swap);
    }
    for (const std::array<Index, 3>& t : surface.triangles) {
        if (binary)
            for (int a = 0; a < 3; ++a) put<float>(file, 0, swap);
        else
            file += "facet normal 0 0 0\nouter loop\n";
        for (const Index n : t) {
            const Vec3& x = surface.nodes[static_cast<std::size_t>(n)];
            if (binary)
                for (const Real value : x) put<float>(file, static_cast<float>(value), swap);
            else
                file += "vertex " + text(x) + "\n";
        }
        binary ? put<std::uint16_t>(file, 0, swap) : void(file += "endloop\nendfacet\n");
    }
    return binary ? file : file + "endsolid body\n";
}

std::vector<SampleFile> all_sample_files(const Mesh& mesh) {
    using Place = VtuForm::Place;
    const SurfaceMesh surface = mesh::boundary(mesh);
    return {{"1.msh", gmsh1_file(mesh)},
            {"22.msh", gmsh2_file(mesh, Bytes::text)},
            {"22b.msh", gmsh2_file(mesh, Bytes::native)},
            {"22f.msh", gmsh2_file(mesh, Bytes::foreign)},
            {"41.msh", gmsh41_file(mesh, Bytes::text)},
            {"41b.msh", gmsh41_file(mesh, Bytes::native)},
            {"41f.msh", gmsh41_file(mesh, Bytes::foreign)},
            {"old.vtk", vtk_file(mesh, false, false)},
            {"oldb.vtk", vtk_file(mesh, false, true)},
            {"new.vtk", vtk_file(mesh, true, false)},
            {"newb.vtk", vtk_file(mesh, true, true)},
            {"text.vtu", vtu_file(mesh, {})},
            {"base64.vtu", vtu_file(mesh, {.place = Place::base64})},
            {"raw.vtu", vtu_file(mesh, {.place = Place::appended_raw, .wide_header = true})},
            {"zip.vtu", vtu_file(mesh, {.place = Place::appended_raw, .compressed = true})},
            {"zip64.vtu", vtu_file(mesh, {.place = Place::base64, .compressed = true})},
            {"zero.node", node_file(mesh, 0)},
            {"zero.ele", ele_file(mesh, 0)},
            {"one.node", node_file(mesh, 1)},
            {"one.ele", ele_file(mesh, 1)},
            {"a.mesh", medit_file(mesh, 0, Bytes::text)},
            {"1.meshb", medit_file(mesh, 2, Bytes::native)},
            {"3.meshb", medit_file(mesh, 3, Bytes::foreign)},
            {"4.meshb", medit_file(mesh, 4, Bytes::native)},
            {"a.inp", abaqus_file(mesh)},
            {"a.obj", obj_file(surface)},
            {"a.ply", ply_file(surface, Bytes::text)},
            {"b.ply", ply_file(surface, Bytes::native)},
            {"c.ply", ply_file(surface, Bytes::foreign)},
            {"a.stl", stl_file(surface, false)},
            {"b.stl", stl_file(surface, true)}};
}

std::string refusal_of_mesh(const std::string& name, const std::string& content) {
    const TemporaryFolder folder;
    const std::string path = folder.write(name, content);
    try {
        mesh::read(path);
    } catch (const SceneError& error) {
        CHECK_THAT(error.what(), Catch::Contains(path));
        return error.what();
    }
    return "nothing refused";
}

}  // namespace skerry::test
