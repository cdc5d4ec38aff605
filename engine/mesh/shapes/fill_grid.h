// Fills the cells of a regular grid with tetrahedra.
#pragma once

#include <array>
#include <vector>

#include "jobs/function_ref.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// Ascending coordinates of the grid lines along x, y and z.
using GridLines = std::array<std::vector<Real>, 3>;

/// Appends the grid lines of `count` equal cells from `lower` to `upper`. `lines` must be empty or end at `lower`.
void append_lines(Real lower, Real upper, int count, std::vector<Real>& lines);

/// Adds six tetrahedra for each cell for which accepts(cell) is true (Kuhn's triangulation). The diagonal of a cell
/// points towards the middle of the grid. The eight octants of the grid are divided as mirror images of each other, so
/// that a symmetric body moves symmetrically. Nodes that no accepted cell uses are omitted. The smallest altitude is
/// 0.71 of the edge of a cubic cell. In another division each cell is the mirror image of its neighbours, and all
/// diagonal edges meet at every second node. It gives better results with linear tetrahedra, but much worse ones with
/// smoothed elements (docs/methods/elasticity.md 7).
Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> accepts);

}  // namespace skerry::mesh
