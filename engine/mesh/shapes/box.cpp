#include "engine/mesh/shapes/add_tetrahedron.h"
#include "engine/mesh/shapes/fill_grid.h"

namespace skerry::mesh {

Mesh box(const Vec3& size, const std::array<int, 3>& cells) {
    GridLines lines;
    double count = 6;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real length = size[static_cast<Eigen::Index>(axis)];
        require_size("box", "size", length);
        require_count("box", "cells", cells[axis]);
        count *= cells[axis];
    }
    require_fits("box", "cells", count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real half = size[static_cast<Eigen::Index>(axis)] / 2;
        append_lines(-half, half, cells[axis], lines[axis]);
    }
    return fill_grid(lines, [](const std::array<int, 3>&) { return true; });
}

}  // namespace skerry::mesh
