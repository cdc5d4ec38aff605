#include <cmath>

#include "engine/base/complaint.h"
#include "engine/mesh/surface/check_shells.h"
#include "engine/mesh/surface/crossings.h"

namespace skerry::mesh {

void require_shells(const SurfaceMesh& surface, const std::string& name, bool may_cross) {
    using enum SurfaceFaultKind;
    SurfaceReport report = check_shells(surface, no_weld, name);
    const auto refuse_any = [&](std::initializer_list<SurfaceFaultKind> kinds, const char* expected, const char* hint) {
        for (const SurfaceFaultKind kind : kinds)
            if (const SurfaceFault* fault = report.find(kind))
                refuse_in(name, "mesh", "triangles", fault_text(*fault), expected, hint);
    };
    refuse_any({flat_triangles, duplicate_triangles, turned_triangles, holes, one_sided_shells}, "a closed surface",
               "repair the surface; skerry inspect FILE lists its faults");
    for (const SurfaceShell& shell : report.shells)
        if (!shell.closed) refuse_any({branching_edges}, "a closed surface", "every edge needs two triangles");
    refuse_any({inside_out_shells, flat_shells}, "a positive volume",
               "triangles must be counter-clockwise as seen from outside: reverse the order of their nodes");
    if (may_cross) return;
    find_crossings(report, rounding_distance(report));
    refuse_any({crossings, shell_crossings, duplicate_shells, doubled_volumes}, "shells that do not overlap",
               "or give mass, center_of_mass and inertia, because volumes that overlap count twice");
}

}  // namespace skerry::mesh
