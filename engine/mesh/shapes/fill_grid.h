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

/// Six tetrahedra in every cell that is kept. A cell is cut along the diagonal that points to the middle of the grid
/// (Kuhn's triangulation): alike on either side of the middle planes, mirrored across them, so that a symmetric body
/// moves symmetrically. Nodes of no kept cell are left out. Smallest altitude 0.71 of a cubic cell's edge. Cells that
/// mirror each of their neighbours suit linear tetrahedra better and smoothed elements much worse
/// (docs/methods/elasticity.md 7.3): edges of diagonals then meet in every other node.
Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> keep);

}  // namespace skerry::mesh
