// Checks of the connections and shells of a surface.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// For SurfaceFaultKind::unlikely_size, fault_text() ends with these words. The scene reader recognises the fault by
/// them.
inline constexpr std::string_view other_unit = "probably in another unit of length";

/// Performs check_surface without the search for crossings, slivers and thin walls. `keep_walls`: see
/// drop_repeated_shells().
SurfaceReport check_shells(const SurfaceMesh& surface, Real tolerance, const std::string& name,
                           bool keep_walls = false);

/// Performs check_surface, but keeps both of two shells that nearly coincide and have the same orientation. Use it if
/// each inner shell bounds a void, whatever its orientation: two such shells are then the two sides of a thin wall.
SurfaceReport check_surface_with_walls(const SurfaceMesh& surface, Real tolerance, const std::string& name);

/// Largest distance at which nodes or shells of a surface count as coincident [m].
inline Real rounding_distance(const SurfaceReport& report) {
    return std::max(report.tolerance, default_weld * (report.upper - report.lower).norm());
}

/// Throws SceneError unless the surface is closed and each of its shells encloses a volume. A shell of negative volume
/// must lie inside another shell, where it bounds a void. Shells may cross each other only if `may_cross`. `name`: name
/// of the file or body for the error message.
void require_shells(const SurfaceMesh& surface, const std::string& name, bool may_cross);

}  // namespace skerry::mesh
