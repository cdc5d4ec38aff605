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

/// Data of a pair that the tests of its candidates share. A rigid cylinder is always the first body of its pair. If
/// both bodies are cylinders, the first is the one whose middle node is the point in the feature keys.
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
    /// Row of the second body in BodyTable, or no_index if the second partner is a collider.
    Index second_body() const { return kind == PairKind::collider ? no_index : second; }
};

/// Contact point between two features. An analytic collider or a rigid cylinder is a single feature. The feature of a
/// sphere or capsule is its core (centre or axis), but against a cylinder it is its surface.
struct ContactPlace {
    Vec3 point;                            // contact point on the second feature [m]
    Vec3 normal;                           // unit normal from the second to the first feature
    Real distance;                         // signed distance of the features [m]
    Real contact_distance;                 // distance that the contact maintains between the features [m]
    Vec3 surface_velocity = Vec3::Zero();  // velocity of a collider at `point` [m/s]
};

ContactRow contact_row(const PairData& pair, std::uint64_t feature, ContactKind kind, const Stencil& stencil,
                       const ContactPlace& place);

/// Returns the feature key of a contact point on a rigid cylinder. `feature`: feature key of the candidate. `number`:
/// number of the contact point among the points of this candidate, counted from 0.
std::uint64_t feature_of_touch(const PairData& pair, std::uint64_t feature, Index number);

// Limits of the numbers of contact points on a cylinder. Contact points with a triangle have numbers below
// touches_of_triangle. Contact points with any other shape have numbers below touches_of_shape; the upper half of these
// numbers is for crossings.
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 512;

/// Contact stencil of a point and a triangle. `node`: node of the point, then nodes of the three corners. Nodes with
/// weight 0 are left out, so that the contact does not connect them to a region.
Stencil stencil_of_point(const std::array<Index, 4>& node, const std::array<Real, 3>& weight);

/// Contact stencil of two edges. `node`: both nodes of the first edge, then both nodes of the second edge. Nodes with
/// weight 0 are left out.
Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest);

/// Merges the rows of all blocks and the rows `more` into one column in key order. The blocks and `more` must be in key
/// order. If a block and `more` contain rows with the same key, only one of the two rows is used: the row of the block
/// if `prefer_blocks` is true, else the row in `more`.
void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged);

}  // namespace skerry
