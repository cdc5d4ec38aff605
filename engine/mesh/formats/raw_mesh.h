// Content of a mesh file before its conversion to a Mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/mesh/formats/file_reader.h"
#include "skerry/mesh.h"
#include "skerry/visual.h"

namespace skerry::mesh {

// Both corners of each edge of a tetrahedron. RawMesh::middle lists the nodes in the middle of the edges in the order
// of these edges. The first three entries are also the edges of a triangle.
constexpr std::array<std::array<std::size_t, 2>, 6> second_order_edges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
// Entries of RawMesh::middle and RawMesh::triangle_middle for a linear element, which has no nodes in the middle of
// edges.
constexpr std::array<Index, 6> linear_tetrahedron{no_index, no_index, no_index, no_index, no_index, no_index};
constexpr std::array<Index, 3> linear_triangle{no_index, no_index, no_index};

/// Nodes and elements of a mesh file. Each element is a row of indices into `nodes`.
struct RawMesh {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 4>> tetrahedra;
    // Nodes in the middle of the edges of each tetrahedron, in the order of `second_order_edges`; `linear_tetrahedron`
    // for a linear one. The list may be shorter than `tetrahedra`; the tetrahedra beyond its end are linear.
    std::vector<std::array<Index, 6>> middle;
    std::vector<int> label;  // label of each tetrahedron; empty: no labels
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::array<Index, 3>> triangle_middle;  // like `middle`, for the triangles
    std::size_t curved_triangles = 0;                   // number of ignored triangles of third or higher order
    std::map<std::string, MeshSet> sets;                // named sets; also faces of second order have only 3 nodes here
    std::map<std::string, std::vector<Vec3>> vectors;   // vector fields by name, one vector per tetrahedron
    // for an .obj or .ply file: texture coordinates and names of materials, and the indices of each triangle into both
    // lists
    VisualSurface visual;
    std::size_t flat_triangles = 0;  // number of triangles of an .obj or .ply file that were dropped, as they use a
                                     // node twice
    std::vector<std::string> material_files;  // for an .obj file: names of its .mtl files
    // number of ignored elements of each kind, for example "hexahedra"
    std::map<std::string, std::size_t> others;
    std::vector<std::string> notes;  // sentences for the user, without the name of the file
};

/// Describes the triangles and the ignored elements of a mesh, for example "12 triangles, 603 hexahedra".
std::string elements_text(const RawMesh& mesh);

/// Maps the node numbers in a file to indices into RawMesh::nodes.
class NodeNumbers {
public:
    void reserve(std::size_t count) { row_.reserve(count); }
    /// Assigns `number` to the node that is added to RawMesh::nodes next. Throws SceneError if another node has the
    /// same number.
    void add(std::int64_t number, const FileReader& reader);
    /// Returns the index of the node with the given number. Throws SceneError if there is no such node.
    Index row(std::int64_t number, const FileReader& reader) const;
    std::size_t size() const { return row_.size(); }

private:
    std::unordered_map<std::int64_t, Index> row_;
};

/// Converts a number from a file to a label. Returns nothing if the number is not whole or does not fit 32 bits.
std::optional<int> as_label(Real number);

/// Throws SceneError if an element uses a node twice.
void require_different(std::span<const Index> nodes, const FileReader& reader);

/// Adds a tetrahedron of first order (4 nodes) or second order (10 nodes: the corners, then the order of
/// RawMesh::middle). Throws SceneError if a node occurs twice.
void take_tetrahedron(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh);
/// Adds a triangle of first order (3 nodes) or second order (6 nodes). Throws SceneError if a node occurs twice.
void take_triangle(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh);

/// Converts a mesh of linear elements to second order. The new nodes are appended to `nodes`.
void add_middle_nodes(RawMesh& mesh);

/// Divides each tetrahedron of second order into eight linear ones, and each triangle of second order into four. The
/// parts use all nodes of the element, get its label and vectors, and replace it in its sets. Adds a sentence about the
/// division to `notes`.
void divide_second_order(RawMesh& mesh);

/// Divides a polygon into triangles that share the polygon's first corner, and adds them to the mesh.
void add_polygon(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh);
/// Adds a polygon of a file that has only a surface. Divides the polygon like add_polygon(), but leaves out triangles
/// that use a node twice, and counts them in `flat_triangles`. Returns an index i for each added triangle, whose
/// corners are nodes[0], nodes[i] and nodes[i + 1].
std::vector<std::size_t> add_surface_polygon(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh);

// Readers of the mesh file formats. All of them throw SceneError for invalid files.
RawMesh read_gmsh(FileReader& reader);  // reads Gmsh file versions 1, 2 and 4.1
RawMesh read_vtk(FileReader& reader);   // reads legacy VTK files with unstructured grids or polygons
RawMesh read_vtu(FileReader& reader);   // reads VTK XML files with unstructured grids
// reads TetGen files .node, .ele and (if it exists) .face of the same name; `path` names the .node or .ele file
RawMesh read_tetgen(const std::string& path);
RawMesh read_abaqus(FileReader& reader);
RawMesh read_medit(FileReader& reader);  // reads Medit files .mesh and .meshb
RawMesh read_obj(FileReader& reader);
/// Reads a Wavefront .mtl file. Paths of textures are relative to the folder of the file.
std::vector<VisualMaterial> read_mtl(FileReader& reader);
RawMesh read_ply(FileReader& reader);
RawMesh read_stl(FileReader& reader);

/// True if files with the extension of this path have triangles but no tetrahedra. Defined in read.cpp.
bool is_surface_format(const std::string& path);

}  // namespace skerry::mesh
