#include "engine/mesh/formats/vtk_cells.h"

#include <algorithm>
#include <map>
#include <set>

namespace skerry::mesh {

namespace {

struct CellKind {
    std::int64_t type;
    const char* name;
};
// VTK cell types that are counted but not read: neither tetrahedra nor triangles of first or second order.
constexpr const char* curved_triangle = "triangles of third or higher order";
constexpr CellKind other_kinds[] = {
    {1, "points"},     {2, "points"},         {3, "lines"},           {4, "lines"},           {6, "triangle strips"},
    {7, "polygons"},   {8, "quadrilaterals"}, {9, "quadrilaterals"},  {11, "hexahedra"},      {12, "hexahedra"},
    {13, "prisms"},    {14, "pyramids"},      {21, "lines"},          {23, "quadrilaterals"}, {25, "hexahedra"},
    {26, "prisms"},    {27, "pyramids"},      {28, "quadrilaterals"}, {29, "hexahedra"},      {34, curved_triangle},
    {42, "polyhedra"}, {68, "lines"},         {69, curved_triangle},  {70, "quadrilaterals"}, {72, "hexahedra"},
    {73, "prisms"},    {74, "pyramids"},      {76, curved_triangle}};

/// True for tetrahedra of first order (VTK type 10) and of second or higher order (24, 71). The caller checks the
/// number of nodes.
bool is_vtk_tetrahedron(std::int64_t type) {
    return type == 10 || type == 24 || type == 71;
}

/// True for triangles of first order (VTK type 5) and of second order (22, or 69 with six nodes).
bool is_triangle(std::int64_t type, std::size_t nodes) {
    return type == 5 || type == 22 || (type == 69 && nodes == 6);
}

}  // namespace

bool is_vtk_label(std::string_view name) {
    return name == "region" || name == "gmsh:physical" || name == "medit:ref" || name == "CellEntityIds";
}

void take_vtk_cells(const VtkCells& cells, FileReader& reader, RawMesh& mesh) {
    for (std::size_t c = 0; c < cells.type.size(); ++c) {
        reader.set_row("cell", c + 1, cells.type.size());
        const std::span<const Index> nodes =
            std::span(cells.node).subspan(cells.offset[c], cells.offset[c + 1] - cells.offset[c]);
        const std::int64_t type = cells.type[c];
        if (is_vtk_tetrahedron(type)) {
            if (nodes.size() != (type == 10 ? 4 : 10))
                reader.complain("node count", std::to_string(nodes.size()),
                                type == 10 ? "4 for a tetrahedron" : "10 for a tetrahedron of second order",
                                "tetrahedra of higher order are not supported");
            take_tetrahedron(nodes, reader, mesh);
            if (!cells.label.empty()) mesh.label.push_back(cells.label[c]);
            for (const auto& [name, of_cell] : cells.vectors)
                if (of_cell.size() == cells.type.size()) mesh.vectors[name].push_back(of_cell[c]);
        } else if (type == 78) {
            reader.complain("type", "78, a Bezier tetrahedron", "type 10, 24 or 71, a tetrahedron of Lagrange type",
                            "export the mesh with linear elements");
        } else if (is_triangle(type, nodes.size())) {
            if (nodes.size() != (type == 5 ? 3 : 6))
                reader.complain("node count", std::to_string(nodes.size()),
                                type == 5 ? "3 for a triangle" : "6 for a triangle of second order");
            take_triangle(nodes, reader, mesh);
        } else {
            const auto* const kind = std::ranges::find(other_kinds, type, &CellKind::type);
            const bool is_known = kind != std::end(other_kinds);
            mesh.others[is_known ? kind->name : "cells of type " + std::to_string(type)] += 1;
            mesh.curved_triangles += is_known && kind->name == curved_triangle;
        }
    }
}

namespace {

/// Calls add(set, row) for each row of an array whose value is not 0. The values determine the sets:
/// - only 0 and 1: one set with the name of the array,
/// - no value occurs twice: no set, because the array only numbers its rows,
/// - otherwise: a set for each value except 0.
void for_each_member(const VtkArray& array, RawMesh& mesh, auto&& add) {
    const std::set<int> values(array.value.begin(), array.value.end());
    const bool is_flag = std::ranges::all_of(values, [](int value) { return value == 0 || value == 1; });
    if (!is_flag && values.size() == array.value.size()) return;
    std::map<int, MeshSet*> set_of;
    for (const int value : values)
        if (value != 0) set_of[value] = &mesh.sets[is_flag ? array.name : array.name + "_" + std::to_string(value)];
    for (std::size_t row = 0; row < array.value.size(); ++row)
        if (array.value[row] != 0) add(*set_of[array.value[row]], row);
}

}  // namespace

void take_vtk_sets(const VtkCells& cells, RawMesh& mesh) {
    for (const VtkArray& array : cells.point_data)
        if (array.value.size() == mesh.nodes.size())
            for_each_member(array, mesh,
                            [](MeshSet& set, std::size_t row) { set.nodes.push_back(static_cast<Index>(row)); });
    std::vector<Index> number;  // by cell: index of its tetrahedron in the mesh, or no_index
    Index tetrahedra = 0;
    for (const std::int64_t type : cells.type) number.push_back(is_vtk_tetrahedron(type) ? tetrahedra++ : no_index);
    for (const VtkArray& array : cells.cell_data)
        if (array.value.size() == cells.type.size())
            for_each_member(array, mesh, [&](MeshSet& set, std::size_t cell) {
                const std::span<const Index> nodes =
                    std::span(cells.node).subspan(cells.offset[cell], cells.offset[cell + 1] - cells.offset[cell]);
                if (number[cell] != no_index)
                    set.tetrahedra.push_back(number[cell]);
                else if (is_triangle(cells.type[cell], nodes.size()))
                    set.faces.push_back({nodes[0], nodes[1], nodes[2]});
                else
                    set.nodes.insert(set.nodes.end(), nodes.begin(), nodes.end());
            });
}

}  // namespace skerry::mesh
