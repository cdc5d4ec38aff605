// Mesh files in the formats of other programs, for the tests of the readers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "skerry/mesh.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

enum class Bytes { text, native, foreign };  // foreign: the other byte order

/// Gmsh files that also contain a triangle, a line and a point, which readers of tetrahedra skip, and an unused node.
std::string gmsh1_file(const Mesh& mesh);
std::string gmsh2_file(const Mesh& mesh, Bytes bytes);
std::string gmsh41_file(const Mesh& mesh, Bytes bytes);

/// VTK file with cells as counts and nodes (before version 5), or as offsets and connectivity. Binary is big-endian.
std::string vtk_file(const Mesh& mesh, bool offsets, bool binary);

std::string node_file(const Mesh& mesh, int first_number);
std::string ele_file(const Mesh& mesh, int first_number);

std::string obj_file(const SurfaceMesh& surface);
std::string stl_file(const SurfaceMesh& surface, bool binary);

struct SampleFile {
    std::string name;
    std::string content;
};
/// One file of each kind with one small mesh; .obj and .stl with its boundary. A .ele file needs the preceding .node
/// file beside it.
std::vector<SampleFile> all_sample_files(const Mesh& mesh);

}  // namespace skerry::test
