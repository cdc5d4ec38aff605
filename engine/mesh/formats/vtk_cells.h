// Cells of VTK files, and the conversion to a mesh that legacy files and XML files share.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

/// A data array with one whole number for each point or each cell.
struct VtkArray {
    std::string name;
    std::vector<int> value;
};

/// Cells of an unstructured grid in the order of the file. Cell c has the nodes node[offset[c]] to node[offset[c + 1] -
/// 1].
struct VtkCells {
    std::vector<std::size_t> offset{0};
    std::vector<Index> node;  // indices into RawMesh::nodes
    std::vector<std::int64_t> type;
    std::vector<int> label;  // label of each cell; empty: no labels
    std::vector<VtkArray> point_data, cell_data;
    // vector arrays by name, one vector per cell; an array with fewer vectors is ignored
    std::map<std::string, std::vector<Vec3>> vectors;
};

/// True if cell data of this name are labels.
bool is_vtk_label(std::string_view name);

/// Adds to a mesh the sets that the data arrays describe by the rules of mesh::read. The mesh must already have its
/// tetrahedra.
void take_vtk_sets(const VtkCells& cells, RawMesh& mesh);

/// Adds the tetrahedra and triangles to the mesh, and counts the cells of other kinds.
void take_vtk_cells(const VtkCells& cells, FileReader& reader, RawMesh& mesh);

}  // namespace skerry::mesh
