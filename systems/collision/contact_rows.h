// Creation and ordering of contact rows.
#pragma once

#include <vector>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// The pair that a contact belongs to.
struct ContactPair {
    std::uint64_t key;
    PairKind kind;
    Index first, second;
};

/// A contact of two bodies or of a body with a collider; its surface velocity is zero. `point`, `distance` and
/// `contact_distance` refer to the features: for a round body to its core.
ContactRow contact_row(const CollisionInputs& inputs, const ContactPair& pair, const Candidate& candidate,
                       ContactKind kind, const Stencil& stencil, const Vec3& point, const Vec3& normal, Real distance,
                       Real contact_distance, const SurfaceProperties& surface);

/// Stencil of a point and a triangle. `node`: the point, then the corners. Nodes with weight 0 are left out, so that
/// they join no regions.
Stencil stencil_of_point(const std::array<Index, 4>& node, const PointTriangle& closest);

/// Stencil of two edges. `node`: the ends of the first edge, then of the second. Nodes with weight 0 are left out.
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// Merges the rows of all blocks with `more`, all in key order, into one column. `prefer_blocks` tells which of two
/// rows with the same key is kept.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
