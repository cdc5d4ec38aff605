// Tetrahedra in the cells of a grid.
#pragma once

#include <array>
#include <vector>

#include "jobs/function_ref.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// Ascending coordinates of the grid lines along x, y and z.
using GridLines = std::array<std::vector<Real>, 3>;

/// `count` equal cells between two coordinates, appended to lines that end at `from` (or are empty).
void append_lines(Real from, Real to, int count, std::vector<Real>& lines);

/// Six tetrahedra in every cell that is kept. A cell is cut along its main diagonal (Kuhn's triangulation) and is the mirror image of each of its
/// neighbours, so the diagonals do not all point the same way. Nodes of no kept cell are left out.
Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> keep);

}  // namespace skerry::mesh
