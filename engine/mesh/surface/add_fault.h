// Adds faults to the report of a surface.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Adds 1 to the number of faults of a kind, and returns the entry of the report for this kind. Only the first fault of
/// a kind sets the place and the triangles of the entry. `triangle`, `other`: faulty triangles, as indices into
/// report.cleaned.triangles.
SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, const Vec3& position,
                        Index other = no_index);
/// Adds a fault whose place is the centre of the triangle.
SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, Index other = no_index);

}  // namespace skerry::mesh
