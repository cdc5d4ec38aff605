// Working memory of solve_regions, reused from step to step. Columns "by contact" follow the order of
// RegionTable::contacts, so the rows of a region are consecutive.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"
#include "components/region_table.h"
#include "systems/solver/coloured/order_region.h"
#include "systems/solver/equations/body_equations.h"
#include "systems/solver/equations/pool.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/cable_law.h"
#include "systems/solver/local/joint_law.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/contact_runs.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// A task solves the regions order[begin] .. order[end - 1] one after the other.
struct RegionTask {
    Index begin, end;
};

/// Data of the regions that are solved by all workers together, and the team of workers.
struct LargeRegions {
    Team team;
    // Entry k belongs to the k-th large region of the step. The vector never shrinks.
    std::vector<std::unique_ptr<ColouredRegion>> region;
};

/// Grows a column to at least `count` rows. Columns never shrink, since shrinking and growing again would clear rows
/// each time.
template <class T>
void make_room(Column<T>& column, std::size_t count) {
    if (column.size() < count) column.resize(count);
}

/// Workspace slot for the contact velocities without impulses. Loading writes these velocities, and the method may
/// later overwrite them.
inline constexpr std::size_t free_velocity_slot = 1;

/// Number of workspace vectors by contact that a method needs. The first one stores the best iterate.
inline std::size_t workspace_slots(SolverMethod method) {
    switch (method) {
        case SolverMethod::pgs:
            return 1;
        case SolverMethod::ags:
        case SolverMethod::automatic:
            return 2;
        default:
            return 4;
    }
}

/// Number of workspace vectors for regions that BodyRegion solves. There the method `automatic` takes Newton steps,
/// which need more vectors. Regions with rows that only sweeps support use `ags` (BodyRegion::method).
inline std::size_t body_workspace_slots(SolverMethod method) {
    return std::max(workspace_slots(SolverMethod::ags),
                    workspace_slots(method == SolverMethod::automatic ? SolverMethod::newton : method));
}

struct RegionMemory {
    // by contact
    Column<LumpedContact> contact;
    Column<Vec4> impulse;  // [N s]
    std::array<Column<Vec4>, workspace_limit> workspace;
    // split impulses; during the velocity solve, normal impulses of frictionless regions [N s]
    Column<Real> push_impulse;
    // biases of the split impulse [m/s]; during the velocity solve, previous normal impulses [N s]
    Column<Real> push_bias;
    // Columns by node of a region. Regions without clusters and rigid bodies have four rows per contact; the rows of
    // the other regions follow.
    Column<Index> node;     // rows of NodeTable
    Column<Vec4> velocity;  // [m/s]
    Column<Vec4> scratch;   // [m/s]
    // Data of regions that touch clusters of nodes or rigid bodies. For each region: list of the touched clusters, and
    // list of the touched rigid bodies.
    Ragged<Index> region_clusters, region_rigid;
    // 1 for each region in which the friction of a contact depends on the direction; empty if no surface has such
    // friction
    Column<std::uint8_t> region_has_axes;
    Column<std::size_t> node_base;  // by region: index of the first node row of the region
    // For each cluster and for each body: the region to whose list find_region_blocks has added it last. The function
    // reads it in order to add nothing to a list twice.
    Column<Index> region_of_cluster, region_of_rigid;
    Column<RigidPart> rigid_part;  // by contact; empty if no step has needed BodyOperator
    // Law of each joint row. Joint rows follow the rows of all contacts, so the law of row k is entry
    // k - contact_rows. The other rows of regions with joints or cables have unused entries.
    Column<JointLaw> joint_law;
    Column<CableLaw> cable_law;   // by solved cable
    Column<Real> cable_mobility;  // mobility matrices of all cables (CableBlock::mobility) [1/kg]
    // Storage of the spans of CableLaw from far_mobility on. The spans lie one after the other; each has one entry per
    // point of all cables.
    Column<Real> cable_numbers;
    // For regions with joints or cables: index of the first row of the region. The contacts of the region come first,
    // then the joints, then the points of the cables.
    Column<std::size_t> joint_base;
    // contact_rows: number of rows of all contacts. rows: contact_rows plus the rows of regions with joints or cables.
    // The contacts of such regions have rows there as well, so that all rows of a region are consecutive.
    std::size_t contact_rows = 0, rows = 0;
    Column<Vec4> free_velocity;  // by row of `velocity`; empty if no step has needed BodyOperator [m/s]
    // For each row of NodeTable: index of the node in the list of its region (NodeList), as stored last. It is outdated
    // if the list now holds another node at this index.
    Column<Index> node_index;
    // by region
    Column<Real> cost;        // predicted time of the solve [microseconds]
    Column<Real> cost_parts;  // partial sums of `cost` over the regions
    // Average numbers of sweeps per region. `history`: regions of the last step, including its sweeps. `present`:
    // regions of this step. After the solve, remember_regions() adds the sweeps of this step to `present` and swaps the
    // two tables.
    RegionHistoryTable history, present;
    // by task
    Column<RegionTask> task;
    LargeRegions large;
    // Pools of working memory for regions that BodyRegion solves, one entry per worker.
    Pool<NewtonEquations> newton;
    Pool<ContactRuns> runs;
    std::atomic<bool> pushed = false;  // true if some region has written push_out in this step

    /// Makes room in the columns by contact and by node.
    void make_room_for(std::size_t contacts, std::size_t region_nodes, std::size_t nodes,
                       const SolverSettings& settings);
    void make_room_for_rigid(std::size_t contacts, std::size_t region_nodes, SolverMethod method) {
        make_room(rigid_part, contacts);
        make_room(free_velocity, region_nodes);
        for (std::size_t slot = 0; slot < body_workspace_slots(method); ++slot) make_room(workspace[slot], contacts);
    }
};

}  // namespace skerry
