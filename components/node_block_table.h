// One row per block of neighbouring nodes of one body.
#pragma once

#include <algorithm>

#include "components/column.h"
#include "components/column_role.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

// Nodes of a round body that a step looks at: its core, which contacts see, and some around it, which tell how fast it
// spins. The others draw it.
inline constexpr Index sphere_step_nodes = 13;   // the middle, and the corners of an icosahedron
inline constexpr Index capsule_step_nodes = 12;  // two ends of the axis, a pole and four at the rim around either
inline constexpr Index cylinder_core_nodes = 3;  // of a cylinder all nodes count: its rims tell how it turns

/// Of all nodes of a body those that a step looks at; `core_nodes`: as in BodyTable.
inline Range step_nodes_of(Range all, Index core_nodes) {
    if (core_nodes == 0 || core_nodes == cylinder_core_nodes) return all;
    return {all.begin, std::min(all.begin + (core_nodes == 1 ? sphere_step_nodes : capsule_step_nodes), all.end)};
}

// fixed: sums over a body are sums over its blocks in order, whatever the worker count
inline constexpr Index nodes_per_block = 256;

/// What one pass over a block of nodes found; added up per body in block order.
struct NodeBlockSums {
    Real mass;              // kg, of the nodes that move
    Vec3 momentum;          // kg m/s
    Vec3 first_moment;      // kg m, sum of m (x - origin)
    Vec3 angular_momentum;  // kg m^2/s, about the origin given
    Mat3 second_moment;     // kg m^2, sum of m (x - origin)(x - origin)^T
    Real dissipated;        // J, kinetic energy of deformation that damping takes out of the block
};

/// Blocks of at most nodes_per_block nodes; a block never crosses from one body to the next. A round body has
/// one, of the nodes that a step looks at.
struct NodeBlockTable {
    Column<Index> begin;  // first node
    Column<Index> end;    // one past the last node
    Column<Index> body;   // row of BodyTable
    // m^2/s^2, of velocity_next + push_out, by check_state; not a number if any node's is not finite
    Column<Real> max_speed_squared;
    Column<Real> frame_speed_squared;   // the same in the body's frame
    Column<Real> displacement_squared;  // m^2, in the body's frame, by advance_positions
    Column<NodeBlockSums> sums;         // by damp_velocity

    /// The only list of columns.
    void for_each_column(auto&& visit) {
        visit("begin", begin, ColumnRole::link);
        visit("end", end, ColumnRole::link);
        visit("body", body, ColumnRole::link);
        visit("max_speed_squared", max_speed_squared, ColumnRole::scratch);
        visit("frame_speed_squared", frame_speed_squared, ColumnRole::scratch);
        visit("displacement_squared", displacement_squared, ColumnRole::memory);
        visit("sums", sums, ColumnRole::scratch);
    }
};

}  // namespace skerry
