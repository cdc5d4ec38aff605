// One row per block of neighbouring nodes of one body.
#pragma once

#include <algorithm>

#include "components/column.h"
#include "components/column_role.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

// Nodes of a round body that take part in a step: its core, which contacts use, and some around it, from which its spin
// is measured. The other nodes only draw it.
inline constexpr Index sphere_step_nodes = 13;   // the centre and the corners of an icosahedron
inline constexpr Index capsule_step_nodes = 12;  // both ends of the axis, with a pole and four rim points at each
inline constexpr Index cylinder_core_nodes = 3;  // all nodes of a cylinder take part: its rims show its rotation

/// The nodes of a body that take part in a step. `core_nodes`: as in BodyTable.
inline Range step_nodes_of(Range all, Index core_nodes) {
    if (core_nodes == 0 || core_nodes == cylinder_core_nodes) return all;
    return {all.begin, std::min(all.begin + (core_nodes == 1 ? sphere_step_nodes : capsule_step_nodes), all.end)};
}

// Fixed, because sums over a body are sums over its blocks in order, whatever the worker count.
inline constexpr Index nodes_per_block = 256;

/// Sums of one pass over a block of nodes; added up per body in block order.
struct NodeBlockSums {
    Real mass;              // mass of the moving nodes [kg]
    Vec3 momentum;          // [kg m/s]
    Vec3 first_moment;      // sum of m (x - origin) [kg m]
    Vec3 angular_momentum;  // about the given origin [kg m^2/s]
    Mat3 second_moment;     // sum of m (x - origin)(x - origin)^T [kg m^2]
    Real dissipated;        // kinetic energy of deformation that damping takes from the block [J]
};

/// Blocks of at most nodes_per_block nodes. A block belongs to one body. A round body has one block, of the nodes that
/// take part in a step.
struct NodeBlockTable {
    Column<Index> begin;  // first node
    Column<Index> end;    // one past the last node
    Column<Index> body;   // row of BodyTable
    // Largest square of velocity_next + push_out, written by check_state [m^2/s^2]; NaN if any node's is not finite.
    Column<Real> max_speed_squared;
    Column<Real> frame_speed_squared;   // the same speed in the body's frame [m^2/s^2]
    Column<Real> displacement_squared;  // in the body's frame, written by advance_positions [m^2]
    Column<NodeBlockSums> sums;         // written by damp_velocity

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
