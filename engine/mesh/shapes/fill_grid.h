// Fills the cells of a grid with tetrahedra.
#pragma once

#include <array>
#include <vector>

#include "jobs/function_ref.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// Ascending coordinates of the grid lines along x, y and z.
using GridLines = std::array<std::vector<Real>, 3>;

/// Appends `count` equal cells between two coordinates to lines that end at `from` (or are empty).
void append_lines(Real from, Real to, int count, std::vector<Real>& lines);

/// Adds six tetrahedra per kept cell (Kuhn's triangulation). The diagonal of a cell points to the middle of the grid.
/// Cells on the same side of the middle planes are divided alike, and mirrored across them, so that a symmetric body
/// moves symmetrically. Nodes without a kept cell are omitted. The smallest altitude is 0.71 of a cubic cell's edge.
/// Mirroring every pair of neighbours would suit linear tetrahedra better and smoothed elements much worse
/// (docs/methods/elasticity.md 7.3): the edges of diagonals would then meet in every other node.
Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> keep);

}  // namespace skerry::mesh
