#include <algorithm>
#include <cmath>

#include "engine/base/complaint.h"
#include "engine/mesh/shapes/add_tetrahedron.h"
#include "engine/mesh/shapes/fill_grid.h"

namespace skerry::mesh {
namespace {

/// Number of cells of about the size `cell` [m] into which `length` [m] is divided, at least one.
int cells_in(Real length, Real cell) {
    const Real count = std::round(length / cell);
    require_fits("table", "cells", count);
    return std::max(1, static_cast<int>(count));
}

}  // namespace

Mesh table(const TableShape& shape) {
    require_size("table", "length", shape.length);
    require_size("table", "width", shape.width);
    require_size("table", "height", shape.height);
    require_size("table", "thickness", shape.thickness);
    require_size("table", "leg", shape.leg);
    require_count("table", "cells_per_leg", shape.cells_per_leg);
    if (!(2 * shape.leg < shape.length && 2 * shape.leg < shape.width))
        refuse("table", "leg", short_text(shape.leg, 6),
               "less than half the length and half the width of the table (m)");
    if (!(shape.thickness < shape.height))
        refuse("table", "thickness", short_text(shape.thickness, 6), "less than the height of the table (m)");

    const Real cell = shape.leg / shape.cells_per_leg;
    const std::array<Real, 2> top{shape.length, shape.width};
    std::array<int, 2> between;  // number of cells between two legs, first along x, then along y
    for (std::size_t axis = 0; axis < 2; ++axis) between[axis] = cells_in(top[axis] - 2 * shape.leg, cell);
    const int leg_layers = cells_in(shape.height - shape.thickness, cell), top_layers = cells_in(shape.thickness, cell);
    require_fits("table", "cells",
                 6.0 * (between[0] + 2.0 * shape.cells_per_leg) * (between[1] + 2.0 * shape.cells_per_leg) *
                     (double{0} + leg_layers + top_layers));

    GridLines lines;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const Real half = top[axis] / 2;
        append_lines(-half, -half + shape.leg, shape.cells_per_leg, lines[axis]);
        append_lines(-half + shape.leg, half - shape.leg, between[axis], lines[axis]);
        append_lines(half - shape.leg, half, shape.cells_per_leg, lines[axis]);
    }
    append_lines(0, shape.height - shape.thickness, leg_layers, lines[2]);
    append_lines(shape.height - shape.thickness, shape.height, top_layers, lines[2]);

    return fill_grid(lines, [&](const std::array<int, 3>& at) {
        const auto over_leg = [&](std::size_t axis) {
            return at[axis] < shape.cells_per_leg || at[axis] >= shape.cells_per_leg + between[axis];
        };
        return at[2] >= leg_layers || (over_leg(0) && over_leg(1));
    });
}

}  // namespace skerry::mesh
