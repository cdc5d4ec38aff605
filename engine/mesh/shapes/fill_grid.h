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

/// Divides each cell for which accepts(cell) is true into six tetrahedra (Kuhn's triangulation). Nodes that no accepted
/// cell uses are omitted. The smallest altitude of a tetrahedron is 0.71 of the edge of a cubic cell.
///
/// The diagonal of each cell points towards the middle of the grid. The eight octants of the grid are therefore mirror
/// images of each other, and a symmetric body moves symmetrically.
Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> accepts);

}  // namespace skerry::mesh
