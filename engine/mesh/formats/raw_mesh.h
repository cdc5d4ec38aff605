// What a mesh file says, before it becomes a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/mesh/formats/file_reader.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// Nodes under the numbers the file gives them, elements in rows of nodes.
struct RawMesh {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<int> label;  // by tetrahedron, or empty
    std::vector<std::array<Index, 3>> triangles;
    std::size_t curved_triangles = 0;  // of second or higher order
    std::size_t others = 0;            // elements of kinds that are passed over
};

/// Rows of nodes by the numbers that a file gives them.
class NodeNumbers {
public:
    void reserve(std::size_t count) { row_.reserve(count); }
    /// The next node has this number. Complains when another has it.
    void add(std::int64_t number, const FileReader& reader);
    /// The row of a number. Complains when there is no such node.
    Index row(std::int64_t number, const FileReader& reader) const;
    std::size_t size() const { return row_.size(); }

private:
    std::unordered_map<std::int64_t, Index> row_;
};

/// A number as a label: whole, and of 32 bits; else nothing.
std::optional<int> as_label(Real number);

/// Complains when an element names a node twice.
template <std::size_t N>
void require_different(const std::array<Index, N>& nodes, const FileReader& reader) {
    for (std::size_t a = 0; a < N; ++a)
        for (std::size_t b = a + 1; b < N; ++b)
            if (nodes[a] == nodes[b]) reader.complain("nodes", "the same node twice", "different nodes");
}

// One function a format. All throw SceneError.
RawMesh read_gmsh(FileReader& reader);         // versions 1, 2 and 4.1
RawMesh read_vtk(FileReader& reader);          // legacy; unstructured grids and polygons
RawMesh read_tetgen(const std::string& path);  // .node and .ele beside each other; either name
RawMesh read_obj(FileReader& reader);
RawMesh read_stl(FileReader& reader);

}  // namespace skerry::mesh
