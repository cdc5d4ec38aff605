// Connections between the triangles of a surface.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Drops triangles with the same nodes as an earlier triangle. Triangles of opposite orientation are kept where closed
/// shells touch: there each of their edges has an even number of triangles. Returns for each remaining triangle the
/// number of the first triangle that repeated it, or no_index.
std::vector<Index> drop_duplicates(SurfaceReport& report);

/// Gives the triangles of `report.cleaned` that common edges connect the orientation of most of them, and divides the
/// triangles into shells. Reports holes, branching edges, pinched nodes, shells without an orientation, and edges at
/// which shells overlap. Removes these faults of an earlier call from the report.
void connect(SurfaceReport& report);

/// Keeps the triangles of `report.cleaned` for which keeps(row) is true.
void keep_triangles(SurfaceReport& report, auto&& keeps) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < report.number.size(); ++t) {
        if (!keeps(t)) continue;
        report.cleaned.triangles[kept] = report.cleaned.triangles[t];
        report.number[kept] = report.number[t];
        if (!report.shell.empty()) report.shell[kept] = report.shell[t];
        ++kept;
    }
    report.cleaned.triangles.resize(kept);
    report.number.resize(kept);
    if (!report.shell.empty()) report.shell.resize(kept);
}

}  // namespace skerry::mesh
