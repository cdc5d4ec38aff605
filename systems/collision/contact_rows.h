// Data of one pair, and functions that create and order contact rows.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// Data of a pair that the tests of its candidates read. If one of two bodies is a rigid cylinder, it comes first. If
/// both are cylinders, the first is the one whose middle node is the point of the candidates.
struct PairData {
    const CollisionInputs& inputs;
    std::uint64_t key;
    PairKind kind;
    Index first, second;
    PairState state;
    PairScale scale;
    SurfaceProperties surface;
    Real travel;  // [m]
    std::span<const Candidate> candidates;

    PairData(const CollisionInputs& all_inputs, const PairTable& pairs, Index p);

    bool can_move(std::span<const Index> nodes) const {
        return std::ranges::any_of(nodes, [&](Index n) { return inputs.inverse_mass[n] > 0; });
    }
    /// Row of the second body, or no_index for a collider.
    Index second_body() const { return kind == PairKind::collider ? no_index : second; }
};

/// Point where two features touch. A collider or a rigid cylinder is a single feature. For a sphere or capsule, the
/// feature is the core (centre or axis); against a cylinder it is the surface.
struct ContactPlace {
    Vec3 point;                            // contact point on the second feature [m]
    Vec3 normal;                           // unit normal from the second to the first feature
    Real distance;                         // signed distance of the features [m]
    Real contact_distance;                 // distance to be kept between the features [m]
    Vec3 surface_velocity = Vec3::Zero();  // velocity of a collider at `point` [m/s]
};

ContactRow contact_row(const PairData& pair, std::uint64_t feature, ContactKind kind, const Stencil& stencil,
                       const ContactPlace& place);

/// Returns the feature key of a touching point on a rigid cylinder. `feature`: key of the candidate. `number`: number
/// of the touching point within this candidate, from 0.
std::uint64_t feature_of_touch(const PairData& pair, std::uint64_t feature, Index number);

// Touching points of a cylinder have numbers below touches_of_triangle on a triangle, and below touches_of_shape on
// another shape. On a shape, the upper half of these numbers is for crossings.
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 512;

/// Stencil of a point and a triangle. `node`: node of the point, then of the three corners. Nodes with weight 0 are
/// left out, so that the contact does not add them to a region.
Stencil stencil_of_point(const std::array<Index, 4>& node, const std::array<Real, 3>& weight);

/// Stencil of two edges. `node`: the ends of the first edge, then the ends of the second edge. Nodes with weight 0 are
/// left out.
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// Merges the rows of all blocks and the rows `more` into one column in key order. All inputs are in key order. If a
/// block and `more` contain the same key, `prefer_blocks` selects the row of the block instead of the row in `more`.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
