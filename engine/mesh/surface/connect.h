// Connections between the triangles of a surface.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Drops duplicate triangles. Returns one entry for each remaining triangle: the number (see SurfaceReport::number) of
/// the first dropped triangle that repeated it, or no_index.
///
/// - A triangle with the nodes and the orientation of an earlier one is dropped.
/// - A triangle with the nodes of an earlier one, but the opposite orientation, can be right, where two closed shells
///   touch. Such triangles are divided into patches that are connected by edges. A patch is kept if an even number of
///   triangles of the surface meet at each of its edges, as in closed shells; otherwise it is dropped.
std::vector<Index> drop_duplicates(SurfaceReport& report);

/// Orients the triangles of `report.cleaned`, each like most triangles connected to it by edges, and divides them into
/// shells. Reports holes, branching edges, pinched nodes, shells without an orientation, and edges at which shells
/// overlap. These faults replace those that an earlier call reported.
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
