// Checks of the connections and shells of a surface.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// End of fault_text for a surface of an unlikely size.
inline constexpr std::string_view other_unit = "probably in another unit of length";

/// Performs check_surface without the search for crossings, slivers and thin walls. `keep_walls`: see
/// drop_repeated_shells.
SurfaceReport check_shells(const SurfaceMesh& surface, Real tolerance, const std::string& name,
                           bool keep_walls = false);

/// Performs check_surface, but keeps shells of the same orientation that are close together. They are the two sides of
/// a thin wall if the inside of inner shells is empty.
SurfaceReport check_surface_with_walls(const SurfaceMesh& surface, Real tolerance, const std::string& name);

/// Distance that counts as rounding error in a surface [m].
inline Real rounding_distance(const SurfaceReport& report) {
    return std::max(report.tolerance, default_weld * (report.upper - report.lower).norm());
}

/// Throws SceneError unless the surface is closed and all of its shells enclose volume. A shell that is inside out must
/// lie in another shell, in which it bounds a void. Shells may cross each other only if `may_cross`. `name`: file or
/// body, for the error.
void require_shells(const SurfaceMesh& surface, const std::string& name, bool may_cross);

}  // namespace skerry::mesh
