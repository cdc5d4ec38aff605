// Data of one pair, and creation and ordering of its contact rows.
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

/// Data of a pair that the evaluation of its candidates reads. If one of two bodies is a rigid cylinder, it comes
/// first; if both are, the first is the one whose middle is the point of the candidates.
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

/// A place where two features touch. Rigid cylinders and colliders are features as a whole, as are the cores of spheres
/// and capsules against anything but a cylinder, and their surfaces against a cylinder.
struct ContactPlace {
    Vec3 point;                            // on the second feature [m]
    Vec3 normal;                           // unit, from the second to the first
    Real distance;                         // of the features, signed [m]
    Real contact_distance;                 // distance kept between the features [m]
    Vec3 surface_velocity = Vec3::Zero();  // of a collider at the point [m/s]
};

ContactRow contact_row(const PairData& pair, std::uint64_t feature, ContactKind kind, const Stencil& stencil,
                       const ContactPlace& place);

/// Feature of a touch of a rigid cylinder. `feature` is that of the candidate, whose touches are numbered from 0.
std::uint64_t feature_of_touch(const PairData& pair, std::uint64_t feature, Index number);

// Touches of a cylinder have numbers below the first constant with a triangle, and below the second with a shape. The
// upper half of the latter is for crossings.
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 512;

/// Stencil of a point and a triangle. `node`: the point, then the corners. Nodes with weight 0 are left out, so that
/// they join no regions.
Stencil stencil_of_point(const std::array<Index, 4>& node, const std::array<Real, 3>& weight);

/// Stencil of two edges. `node`: the ends of the first edge, then of the second. Nodes with weight 0 are left out.
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// Merges the rows of all blocks with `more`, all in key order, into one column. `prefer_blocks` tells which of two
/// rows with the same key is kept.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
