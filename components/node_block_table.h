// One row per block of neighbouring nodes of one body.
#pragma once

#include <algorithm>

#include "components/column.h"
#include "components/column_role.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

// Number of nodes of a round body that take part in a step. They are its core, which contacts use, and nodes around it,
// from which its spin is measured. All other nodes serve only to display the body.
inline constexpr Index sphere_step_nodes = 13;  // count: the centre and the 12 corners of an icosahedron
// Count: both ends of the axis, with a pole and four rim points at each end.
inline constexpr Index capsule_step_nodes = 12;
// Number of core nodes of a cylinder. All nodes of a cylinder take part in a step, because its rims show its rotation.
inline constexpr Index cylinder_core_nodes = 3;

/// The nodes of a body that take part in a step. `core_nodes`: see BodyTable.
inline Range step_nodes_of(Range all, Index core_nodes) {
    if (core_nodes == 0 || core_nodes == cylinder_core_nodes) return all;
    return {all.begin, std::min(all.begin + (core_nodes == 1 ? sphere_step_nodes : capsule_step_nodes), all.end)};
}

// Fixed block size: sums over a body are sums over its blocks in order, so they do not depend on the number of workers.
inline constexpr Index nodes_per_block = 256;

/// Sums over the nodes of one block. The sums of a body are added up in block order.
struct NodeBlockSums {
    Real mass;              // mass of the moving nodes [kg]
    Vec3 momentum;          // [kg m/s]
    Vec3 first_moment;      // sum of m (x - origin) [kg m]
    Vec3 angular_momentum;  // angular momentum about the given origin [kg m^2/s]
    Mat3 second_moment;     // sum of m (x - origin)(x - origin)^T [kg m^2]
    Real dissipated;        // kinetic energy of deformation that damping removes from the block [J]
};

/// Blocks of at most nodes_per_block nodes of one body. A round body has one block, which contains the nodes that take
/// part in a step.
struct NodeBlockTable {
    Column<Index> begin;  // first node
    Column<Index> end;    // one past the last node
    Column<Index> body;   // row of BodyTable
    // Largest square of |velocity_next + push_out| among the nodes, written by check_state [m^2/s^2]. NaN if a velocity
    // is not finite.
    Column<Real> max_speed_squared;
    Column<Real> frame_speed_squared;  // largest squared speed of a node in the body's frame [m^2/s^2]
    // Largest squared displacement in the body's frame, written by advance_positions [m^2].
    Column<Real> displacement_squared;
    Column<NodeBlockSums> sums;  // written by damp_velocity

    /// Visits all columns. This is the only list of them.
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
