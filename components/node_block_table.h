// One row per block of neighbouring nodes of one body.
#pragma once

#include <algorithm>

#include "components/column.h"
#include "components/column_role.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

// Number of nodes of a sphere that take part in a step. These are the core nodes, which contacts use, and the nodes
// from which the angular velocity of the body is measured. All other nodes serve only to display the body.
inline constexpr Index sphere_step_nodes = 13;  // the centre and the 12 corners of an icosahedron
// Number of nodes of a capsule that take part in a step: both ends of the axis, and on each end cap its pole and four
// points of its rim.
inline constexpr Index capsule_step_nodes = 12;
// Number of core nodes of a cylinder. All nodes of a cylinder take part in a step, because its rotation is measured
// from the nodes on its rims.
inline constexpr Index cylinder_core_nodes = 3;

/// The nodes of a body that take part in a step. `all`: all nodes of the body. `core_nodes`: see BodyTable.
inline Range step_nodes_of(Range all, Index core_nodes) {
    if (core_nodes == 0 || core_nodes == cylinder_core_nodes) return all;
    return {all.begin, std::min(all.begin + (core_nodes == 1 ? sphere_step_nodes : capsule_step_nodes), all.end)};
}

// Number of nodes per block. It is fixed, because sums over a body are computed block by block. With a fixed block size
// they do not depend on the number of workers.
inline constexpr Index nodes_per_block = 256;

/// Sums over the nodes of one block that can move, with positions x and velocities v relative to the first node of the
/// body.
///
/// damp_velocity adds up all blocks of a body in block order, and stores the totals in the entry of the first block. In
/// these totals, `momentum` is in the world frame, and `angular_momentum` and `second_moment` are about the centre of
/// mass.
struct NodeBlockSums {
    Real mass;              // total mass [kg]
    Vec3 momentum;          // sum of m v, with node masses m [kg m/s]
    Vec3 first_moment;      // sum of m x [kg m]
    Vec3 angular_momentum;  // sum of m x cross v [kg m^2/s]
    // sum of m y x^T, with the position y = x - lag v at the time of v; `lag`: time by which positions are ahead of
    // velocities (damp_velocity.cpp) [kg m^2]
    Mat3 second_moment;
    Real dissipated;  // kinetic energy of deformation that damping removes from the nodes of the block [J]
};

/// Blocks of at most nodes_per_block nodes of one body. A round body has a single block, which contains the nodes that
/// take part in a step.
struct NodeBlockTable {
    Column<Index> begin;  // first node
    Column<Index> end;    // one past the last node
    Column<Index> body;   // row of BodyTable
    // Largest square of |velocity_next + push_out| among the nodes of the block, written by check_state [m^2/s^2]. NaN
    // if a velocity is not finite.
    Column<Real> max_speed_squared;
    // largest squared speed of a node relative to the moving frame of its body [m^2/s^2]
    Column<Real> frame_speed_squared;
    // Largest squared displacement of a node relative to the moving frame of its body, written by advance_positions
    // [m^2].
    Column<Real> displacement_squared;
    Column<NodeBlockSums> sums;  // written by damp_velocity

    /// Visits all columns. This is the only list of the columns.
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
