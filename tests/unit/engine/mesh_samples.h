// Mesh files as other programs write them, for the tests of the readers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "skerry/mesh.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

enum class Bytes { text, native, foreign };  // foreign: the other byte order

/// With a triangle, a line and a point among the elements, which readers of tetrahedra pass over, and a node nobody
/// uses.
std::string gmsh1_file(const Mesh& mesh);
std::string gmsh2_file(const Mesh& mesh, Bytes bytes);
std::string gmsh41_file(const Mesh& mesh, Bytes bytes);

/// Cells as counts and nodes (before version 5), or as offsets and connectivity. Binary is big-endian.
std::string vtk_file(const Mesh& mesh, bool offsets, bool binary);

std::string node_file(const Mesh& mesh, int first_number);
std::string ele_file(const Mesh& mesh, int first_number);

std::string obj_file(const SurfaceMesh& surface);
std::string stl_file(const SurfaceMesh& surface, bool binary);

struct SampleFile {
    std::string name;
    std::string content;
};
/// One file of each kind, of the same small mesh; .obj and .stl of its boundary. A .ele needs the .node before it
/// beside it.
std::vector<SampleFile> all_sample_files(const Mesh& mesh);

}  // namespace skerry::test
