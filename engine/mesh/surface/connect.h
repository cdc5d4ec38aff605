// Connections between the triangles of a surface.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Drops triangles with the same nodes as an earlier triangle, if they have its orientation. Triangles of opposite
/// orientation can also be right, where two closed shells touch. They are divided into patches that are connected by
/// edges. A patch is kept if an even number of triangles of the surface meet at each of its edges, as in closed shells;
/// otherwise it is dropped. Returns one entry for each remaining triangle: the number (see SurfaceReport::number) of
/// the first dropped triangle that repeated it, or no_index.
std::vector<Index> drop_duplicates(SurfaceReport& report);

/// Turns triangles of `report.cleaned` so that triangles connected by edges have the orientation that most of them
/// have, and divides the triangles into shells. Reports holes, branching edges, pinched nodes, shells without an
/// orientation, and edges at which shells overlap. These faults replace those that an earlier call reported.
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
