// Adds faults to the report of a surface.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Adds a fault to those of its kind. The first fault of a kind sets the place. `triangle`, `other`: rows of
/// `report.cleaned`. Returns the faults of the kind.
SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, const Vec3& place,
                        Index other = no_index);
/// Adds a fault whose place is the centre of the triangle.
SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, Index other = no_index);

}  // namespace skerry::mesh
