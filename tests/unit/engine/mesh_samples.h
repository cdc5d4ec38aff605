// Mesh files in the formats of other programs, for the tests of the readers.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "skerry/mesh.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

enum class Bytes { text, native, foreign };  // foreign: the other byte order

/// Replaces the first `from` in a text. Throws std::invalid_argument if there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::invalid_argument("the text does not contain \"" + from + "\"");
    return text.replace(at, from.size(), to);
}

/// Gmsh files that also contain a triangle, a line and a point, which readers of tetrahedra skip, and an unused node.
std::string gmsh1_file(const Mesh& mesh);
std::string gmsh2_file(const Mesh& mesh, Bytes bytes);
std::string gmsh41_file(const Mesh& mesh, Bytes bytes);

/// VTK file with cells as counts and nodes (before version 5), or as offsets and connectivity. Binary is big-endian.
std::string vtk_file(const Mesh& mesh, bool offsets, bool binary);

/// Form of a VTK XML file.
struct VtuForm {
    enum class Place { ascii, base64, appended_raw, appended_base64 };
    Place place = Place::ascii;
    bool compressed = false;   // in blocks of zlib, several per array
    bool wide_header = false;  // UInt64 instead of UInt32
    bool wide_numbers = true;  // Float64 and Int64 instead of Float32 and Int32
    bool foreign_bytes = false;
    // compresses a block; empty: a zlib stream that stores the bytes as they are
    std::string (*pack)(const std::string&) = nullptr;
};
/// VTK XML file with an unused node and a triangle.
std::string vtu_file(const Mesh& mesh, const VtuForm& form);

std::string node_file(const Mesh& mesh, int first_number);
std::string ele_file(const Mesh& mesh, int first_number);

/// Medit file with an unused vertex, a triangle and a section that readers skip. `version`: of a binary file, 1 to 4.
std::string medit_file(const Mesh& mesh, int version, Bytes bytes);
/// Abaqus file with an unused node and a shell. The material of a tetrahedron with the label N is MN.
std::string abaqus_file(const Mesh& mesh);

std::string obj_file(const SurfaceMesh& surface);
/// PLY file with a normal and a colour beside each position, and with an element that readers skip.
std::string ply_file(const SurfaceMesh& surface, Bytes bytes);
std::string stl_file(const SurfaceMesh& surface, bool binary);

struct SampleFile {
    std::string name;
    std::string content;
};
/// One file of each kind with one small mesh; .obj, .ply and .stl with its boundary. A .ele file needs the preceding
/// .node file beside it.
std::vector<SampleFile> all_sample_files(const Mesh& mesh);

/// Error message when a mesh file of this name and content is read. Checks that the message contains the path.
std::string refusal_of_mesh(const std::string& name, const std::string& content);

}  // namespace skerry::test
