// Working memory of solve_regions. Rows "by contact" are in the order of RegionTable::contacts, so that a region's rows are consecutive.
#pragma once

#include <array>
#include <atomic>

#include "components/column.h"
#include "systems/solver/operators/lumped_operator.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// Regions order[begin] .. order[end - 1], solved one after the other.
struct RegionTask {
    Index begin, end;
};

struct SolverMemory::Data {
    // by contact
    Column<LumpedContact> contact;
    Column<Vec4> impulse;  // N s
    std::array<Column<Vec4>, 4> workspace;
    Column<Real> push_impulse;  // N s, of the split impulse
    Column<Real> push_bias;     // m/s
    // four places by contact: a region never has more nodes
    Column<Index> node;     // rows of NodeTable
    Column<Vec4> velocity;  // m/s
    Column<Vec4> scratch;   // m/s
    // by row of NodeTable
    Column<Index> place;  // in its region's list of nodes, if that list agrees
    // by task
    Column<RegionTask> task;
    std::atomic<bool> pushed = false;  // some region wrote push_out in this step
};

/// Longer if need be, never shorter: a column that shrinks and grows again would be cleared each time.
template <class T>
void make_room(Column<T>& column, std::size_t count) {
    if (column.size() < count) column.resize(count);
}

/// How many vectors by contact a method works with; the first keeps the best iterate.
inline std::size_t workspace_slots(SolverMethod method) {
    if (method == SolverMethod::pgs) return 1;
    return method == SolverMethod::ags || method == SolverMethod::automatic ? 2 : 4;
}

}  // namespace skerry
