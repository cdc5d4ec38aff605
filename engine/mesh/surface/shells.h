// Volumes of the shells of a surface, and shells inside other shells.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Drops shells that repeat an earlier one, and reports them. `distance`: distance up to which shells of any
/// orientation count as equal [m]. `keep_walls`: false if shells of the same orientation also count as equal up to a
/// thousandth of their size, although they may be the two sides of a thin wall. Returns true if shells were dropped;
/// then call connect() again.
bool drop_repeated_shells(SurfaceReport& report, Real distance, bool keep_walls);

/// Computes the volumes of closed shells, finds for each shell the shell around it, and turns shells that are inside
/// out together with the shells inside them. Reports these shells, shells without volume and volumes that several
/// shells enclose.
void compare_shells(SurfaceReport& report);

}  // namespace skerry::mesh
