// Volumes of the shells of a surface, and shells inside other shells.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Drops shells that repeat an earlier one, and reports them. Returns true if shells were dropped; then call connect()
/// again. A shell repeats another one if the two are at most this far apart [m]:
/// - `distance`,
/// - or, for shells of the same orientation, a thousandth of their diagonal if that is larger. With `keep_walls` this
///   second limit is not used, because such shells may be the two sides of a thin wall.
bool drop_repeated_shells(SurfaceReport& report, Real distance, bool keep_walls);

/// Computes the volumes of closed shells, and finds for each shell the smallest shell around it. Reverses each shell
/// that is inside out, together with the shells inside it. Reports the reversed shells, shells without volume, and
/// volumes that several shells enclose.
void compare_shells(SurfaceReport& report);

}  // namespace skerry::mesh
