// Checks of the connections and shells of a surface.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Last words of fault_text for SurfaceFaultKind::unlikely_size. The scene reader recognises this fault by these words.
inline constexpr std::string_view other_unit = "probably in another unit of length";

/// Performs check_surface without the search for crossings, slivers and thin walls. `keep_walls`: see
/// drop_repeated_shells.
SurfaceReport check_shells(const SurfaceMesh& surface, Real tolerance, const std::string& name,
                           bool keep_walls = false);

/// Performs check_surface, but keeps a shell that nearly coincides with another one of the same orientation: if inner
/// shells bound voids, these two shells are the sides of a thin wall.
SurfaceReport check_surface_with_walls(const SurfaceMesh& surface, Real tolerance, const std::string& name);

/// Distance up to which nodes or shells of a surface count as coincident [m].
inline Real rounding_distance(const SurfaceReport& report) {
    return std::max(report.tolerance, default_weld * (report.upper - report.lower).norm());
}

/// Throws SceneError unless the surface is closed and all of its shells enclose volume. A shell of negative volume must
/// lie inside another shell, where it bounds a void. Shells may cross each other only if `may_cross`. `name`: file or
/// body, for the error.
void require_shells(const SurfaceMesh& surface, const std::string& name, bool may_cross);

}  // namespace skerry::mesh
