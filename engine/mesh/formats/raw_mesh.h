// Content of a mesh file before conversion to a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/mesh/formats/file_reader.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// Nodes, and elements as rows of indices into them.
struct RawMesh {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<int> label;  // by tetrahedron, or empty
    std::vector<std::array<Index, 3>> triangles;
    std::size_t curved_triangles = 0;  // number of triangles of second or higher order
    std::size_t others = 0;            // number of elements of ignored kinds
};

/// Maps the node numbers of a file to rows of nodes.
class NodeNumbers {
public:
    void reserve(std::size_t count) { row_.reserve(count); }
    /// Gives the next node this number. Throws SceneError if another node has it.
    void add(std::int64_t number, const FileReader& reader);
    /// Returns the row of a number. Throws SceneError if there is no such node.
    Index row(std::int64_t number, const FileReader& reader) const;
    std::size_t size() const { return row_.size(); }

private:
    std::unordered_map<std::int64_t, Index> row_;
};

/// Converts a number to a label; empty unless it is a 32-bit whole number.
std::optional<int> as_label(Real number);

/// Throws SceneError if an element uses a node twice.
template <std::size_t N>
void require_different(const std::array<Index, N>& nodes, const FileReader& reader) {
    for (std::size_t a = 0; a < N; ++a)
        for (std::size_t b = a + 1; b < N; ++b)
            if (nodes[a] == nodes[b]) reader.complain("nodes", "the same node twice", "different nodes");
}

// One function for each format. All throw SceneError.
RawMesh read_gmsh(FileReader& reader);         // versions 1, 2 and 4.1
RawMesh read_vtk(FileReader& reader);          // legacy format; unstructured grids and polygons
RawMesh read_tetgen(const std::string& path);  // .node and .ele with the same base name; either name is accepted
RawMesh read_obj(FileReader& reader);
RawMesh read_stl(FileReader& reader);

}  // namespace skerry::mesh
