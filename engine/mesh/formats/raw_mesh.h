// Content of a mesh file before its conversion to a Mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/mesh/formats/file_reader.h"
#include "skerry/mesh.h"
#include "skerry/visual.h"

namespace skerry::mesh {

/// Nodes and elements of a mesh file. Each element is a row of indices into `nodes`.
struct RawMesh {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<int> label;  // label of each tetrahedron; empty: no labels
    std::vector<std::array<Index, 3>> triangles;
    std::size_t curved_triangles = 0;  // number of triangles of second or higher order
    std::map<std::string, MeshSet> sets;
    std::map<std::string, std::vector<Vec3>> vectors;  // of the tetrahedra
    VisualSurface visual;  // of an .obj file: texture coordinates, names of materials, and both by triangle
    std::vector<std::string> material_files;  // of an .obj file: names of its .mtl files
    // number of ignored elements of each kind, for example "hexahedra"
    std::map<std::string, std::size_t> others;
};

/// Describes the triangles and the ignored elements of a mesh, for example "12 triangles, 603 hexahedra".
std::string elements_text(const RawMesh& mesh);

/// Maps the node numbers in a file to indices into RawMesh::nodes.
class NodeNumbers {
public:
    void reserve(std::size_t count) { row_.reserve(count); }
    /// Assigns `number` to the next node. Throws SceneError if another node has the same number.
    void add(std::int64_t number, const FileReader& reader);
    /// Returns the index of the node with the given number. Throws SceneError if there is no such node.
    Index row(std::int64_t number, const FileReader& reader) const;
    std::size_t size() const { return row_.size(); }

private:
    std::unordered_map<std::int64_t, Index> row_;
};

/// Converts a number from a file to a label. Returns nothing unless the number is a whole number that fits 32 bits.
std::optional<int> as_label(Real number);

/// Throws SceneError if an element uses a node twice.
template <std::size_t N>
void require_different(const std::array<Index, N>& nodes, const FileReader& reader) {
    for (std::size_t a = 0; a < N; ++a)
        for (std::size_t b = a + 1; b < N; ++b)
            if (nodes[a] == nodes[b])
                reader.complain("nodes", "the same node twice", "an element whose nodes all differ",
                                "remove this element or correct its nodes");
}

// Readers of the mesh file formats. All of them throw SceneError for invalid files.
RawMesh read_gmsh(FileReader& reader);  // reads Gmsh file versions 1, 2 and 4.1
RawMesh read_vtk(FileReader& reader);   // reads legacy VTK files with unstructured grids or polygons
RawMesh read_vtu(FileReader& reader);   // reads VTK XML files with unstructured grids
// reads TetGen files .node and .ele of the same name; `path` may name either file
RawMesh read_tetgen(const std::string& path);
RawMesh read_obj(FileReader& reader);
/// Reads a Wavefront .mtl file. Paths of textures are relative to the folder of the file.
std::vector<VisualMaterial> read_mtl(FileReader& reader);
RawMesh read_stl(FileReader& reader);

}  // namespace skerry::mesh
