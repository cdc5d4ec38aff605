// Working memory of solve_regions, kept between steps. Rows "by contact" are in the order of RegionTable::contacts, so
// that a region's rows are consecutive.
#pragma once

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
#include "systems/solver/local/joint_law.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/contact_runs.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Regions order[begin] .. order[end - 1], solved one after the other.
struct RegionTask {
    Index begin, end;
};

/// Regions that are worth all workers each.
struct LargeRegions {
    Team team;
    std::vector<std::unique_ptr<ColouredRegion>> region;  // the first large region of the step, the second, ...
};

/// Longer if need be, never shorter: a column that shrinks and grows again would be cleared each time.
template <class T>
void make_room(Column<T>& column, std::size_t count) {
    if (column.size() < count) column.resize(count);
}

/// Where loading leaves the velocities of the contacts without impulses, until the method uses the place itself.
inline constexpr std::size_t free_velocity_slot = 1;

/// How many vectors by contact a method works with; the first keeps the best iterate.
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

/// The same of regions that touch rigid bodies, whose default takes Newton steps.
inline std::size_t freedom_workspace_slots(SolverMethod method) {
    return workspace_slots(method == SolverMethod::automatic ? SolverMethod::newton : method);
}

struct RegionMemory {
    // by contact
    Column<LumpedContact> contact;
    Column<Vec4> impulse;  // N s
    std::array<Column<Vec4>, workspace_limit> workspace;
    Column<Real> push_impulse;  // N s, of the split impulse; before that the normal impulses of frictionless regions
    Column<Real> push_bias;     // m/s; likewise the previous ones
    // four places by contact: a region never has more nodes, but for those of clusters
    Column<Index> node;     // rows of NodeTable
    Column<Vec4> velocity;  // m/s
    Column<Vec4> scratch;   // m/s
    // of regions that touch clusters of nodes or rigid bodies
    Ragged<Index> region_clusters, region_rigid;       // by region; no rows without either
    Column<std::size_t> node_base;                     // by region: place of its first node
    Column<Index> region_of_cluster, region_of_rigid;  // that touched it last
    Column<RigidPart> rigid_part;                      // by contact; no rows without rigid bodies
    Column<JointLaw> joint_law;                        // by row behind those of all contacts
    // of regions with joints, whose rows come behind those of all contacts: the place of the first, contacts first
    Column<std::size_t> joint_base;
    std::size_t contact_rows = 0, rows = 0;  // of all contacts, and with those
    Column<Vec4> free_velocity;              // m/s, as `velocity`; no rows without rigid bodies
    // by row of NodeTable
    Column<Index> place;  // in its region's list of nodes, if that list agrees
    // by region
    Column<Real> cost;           // microseconds, predicted
    Column<Real> cost_parts;     // working memory
    RegionHistoryTable history;  // of the last step; then
    RegionHistoryTable present;  // of this one
    // by task
    Column<RegionTask> task;
    LargeRegions large;
    // of regions that touch rigid bodies
    Pool<NewtonEquations> newton;
    Pool<ContactRuns> runs;
    std::atomic<bool> pushed = false;  // some region wrote push_out in this step

    /// Of the columns by contact and by node.
    void make_room_for(std::size_t contacts, std::size_t region_nodes, std::size_t nodes,
                       const SolverSettings& settings);
    void make_room_for_rigid(std::size_t contacts, std::size_t region_nodes, SolverMethod method) {
        make_room(rigid_part, contacts);
        make_room(free_velocity, region_nodes);
        for (std::size_t slot = 0; slot < freedom_workspace_slots(method); ++slot) make_room(workspace[slot], contacts);
    }
};

}  // namespace skerry
