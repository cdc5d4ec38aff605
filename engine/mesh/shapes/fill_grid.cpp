#include "engine/mesh/shapes/fill_grid.h"

#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {

void append_lines(Real lower, Real upper, int count, std::vector<Real>& lines) {
    if (lines.empty()) lines.push_back(lower);
    for (int i = 1; i < count; ++i) lines.push_back(lower + (upper - lower) * i / count);
    lines.push_back(upper);
}

Mesh fill_grid(const GridLines& lines, FunctionRef<bool(const std::array<int, 3>& cell)> accepts) {
    const auto lines_along = [&](std::size_t axis) { return static_cast<int>(lines[axis].size()); };
    std::vector<Index> row(lines[0].size() * lines[1].size() * lines[2].size(), no_index);
    Mesh mesh;
    const auto node_at = [&](const std::array<int, 3>& p) {
        const auto grid_index =
            (static_cast<std::size_t>(p[2]) * lines[1].size() + static_cast<std::size_t>(p[1])) * lines[0].size() +
            static_cast<std::size_t>(p[0]);
        if (row[grid_index] == no_index) {
            row[grid_index] = static_cast<Index>(mesh.nodes.size());
            mesh.nodes.emplace_back(lines[0][static_cast<std::size_t>(p[0])], lines[1][static_cast<std::size_t>(p[1])],
                                    lines[2][static_cast<std::size_t>(p[2])]);
        }
        return row[grid_index];
    };

    // Each permutation of the three axes gives a path along three edges of the cell, from one end of its space diagonal
    // to the other. The four nodes of the path form a tetrahedron.
    constexpr std::array<std::array<std::size_t, 3>, 6> walks{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    std::array<int, 3> cell;
    // The division of a cell depends on its octant of the grid. If instead each cell were the mirror image of its
    // neighbours, all diagonal edges would meet at every second node. That gives better results with linear tetrahedra,
    // but much worse ones with smoothed elements (docs/methods/elasticity.md 7).
    const auto mirrored = [&](std::size_t axis) { return 2 * cell[axis] + 1 >= lines_along(axis); };
    for (cell[2] = 0; cell[2] + 1 < lines_along(2); ++cell[2])
        for (cell[1] = 0; cell[1] + 1 < lines_along(1); ++cell[1])
            for (cell[0] = 0; cell[0] + 1 < lines_along(0); ++cell[0]) {
                if (!accepts(cell)) continue;
                for (const std::array<std::size_t, 3>& walk : walks) {
                    std::array<int, 3> corner;  // corner of the cell that is farthest from the middle of the grid
                    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] = cell[axis] + (mirrored(axis) ? 1 : 0);
                    std::array<Index, 4> nodes{node_at(corner)};
                    for (std::size_t i = 0; i < 3; ++i) {
                        corner[walk[i]] += mirrored(walk[i]) ? -1 : 1;
                        nodes[i + 1] = node_at(corner);
                    }
                    add_tetrahedron(mesh, nodes);
                }
            }
    return mesh;
}

}  // namespace skerry::mesh
