// Data that all candidates of a pair share, and functions that create and sort contact rows.
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

/// Data of a pair that the tests of its candidates share. If one body is a rigid cylinder, `first` is this body, even
/// if it is the second body in PairTable. If both bodies are cylinders, the order of PairTable is kept.
struct PairData {
    const CollisionInputs& inputs;
    std::uint64_t key;
    PairKind kind;
    Index first, second;
    PairState state;
    PairScale scale;
    SurfaceProperties surface;
    Real travel;  // travel T of the pair at the start of this step (contact_reach.h) [m]
    std::span<const Candidate> candidates;

    PairData(const CollisionInputs& all_inputs, const PairTable& pairs, Index p);

    bool can_move(std::span<const Index> nodes) const {
        return std::ranges::any_of(nodes, [&](Index n) { return inputs.inverse_mass[n] > 0; });
    }
    /// Row of the second body in BodyTable, or no_index if the second partner is a collider.
    Index second_body() const { return kind == PairKind::collider ? no_index : second; }
};

/// Contact point between two features. An analytic collider or a rigid cylinder is a single feature. The feature of a
/// sphere or capsule is its core (centre or axis); in a pair with a cylinder it is the surface of the sphere or
/// capsule.
struct ContactGeometry {
    Vec3 point;                            // contact point on the second feature [m]
    Vec3 normal;                           // unit normal from the second to the first feature
    Real distance;                         // signed distance of the features [m]
    Real contact_distance;                 // distance that the contact maintains between the features [m]
    Vec3 surface_velocity = Vec3::Zero();  // velocity of an analytic collider at `point`; 0 for two bodies [m/s]
};

/// Contact row of a pair.
ContactRow contact_row(const PairData& pair, std::uint64_t feature, ContactKind kind, const Stencil& stencil,
                       const ContactGeometry& geometry);

/// Returns the feature key of a contact point on a rigid cylinder. `feature`: feature key of the candidate. `number`:
/// number of the contact point among the points of this candidate, counted from 0.
std::uint64_t feature_of_touch(const PairData& pair, std::uint64_t feature, Index number);

// The argument `number` of feature_of_touch is below touches_of_triangle for a cylinder and a triangle, and below
// touches_of_shape for a cylinder and any other shape. The upper half of the range below touches_of_shape is for
// crossings (cylinder_crossings.cpp).
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 512;

/// Contact stencil of a point and a triangle. `node`: node of the point, then nodes of the three corners. Corners with
/// weight 0 are replaced by the node of the point. Otherwise two contacts that share only such a corner would be solved
/// together (RegionTable).
Stencil stencil_of_point(const std::array<Index, 4>& node, const std::array<Real, 3>& weight);

/// Contact stencil of two edges. `node`: both nodes of the first edge, then both nodes of the second edge. Nodes with
/// weight 0 are replaced by another node of the stencil. Otherwise two contacts that share only such a node would be
/// solved together (RegionTable).
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// Merges the rows of all blocks and the rows `more` into `merged`, in key order. Both the concatenated rows of the
/// blocks and `more` must be in key order. If a block and `more` have rows with the same key, only the row of the block
/// is used if `prefer_blocks` is true, else only that in `more`.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
