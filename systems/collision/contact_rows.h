// Rows of contacts: how they are made and put in order.
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

/// A contact of two bodies or of a body with a collider (which has no velocity yet). `point`, `distance` and
/// `contact_distance` are of the features: a round body is its core.
ContactRow contact_row(const CollisionInputs& inputs, const ContactPair& pair, const Candidate& candidate,
                       ContactKind kind, const Stencil& stencil, const Vec3& point, const Vec3& normal, Real distance,
                       Real contact_distance, const SurfaceProperties& surface);

/// `node`: the point, then the corners. Nodes without weight are left out: they join no regions.
Stencil stencil_of_point(const std::array<Index, 4>& node, const PointTriangle& closest);

/// `node`: the ends of the first edge, then of the second. Nodes without weight are left out.
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// The rows of all blocks and `more`, all in key order, in one; `prefer_blocks` says which of two rows with the same
/// key stays.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
