// What loads and held nodes gave to the moving nodes in this step, for the balance of a run.
#pragma once

#include <span>

#include "components/column.h"
#include "components/resting_nodes.h"
#include "jobs/executor.h"

namespace skerry {

struct ExternalWork {
    Vec3 impulse = Vec3::Zero();  // N s
    Real work = 0;                // J
};

/// Loads on all nodes (none: `load` empty) and the forces that hold the nodes `held`, which are the opposite of `force` there: impulse h F and
/// work h F . velocity_next, the displacement of a symplectic step. Nodes at rest do not count:
/// what holds them is not known. The loads' sum goes over fixed blocks, in their order.
ExternalWork measure_work(Executor& executor, std::span<const Vec3> load, std::span<const Vec3> force, std::span<const Index> held,
                          std::span<const Vec3> velocity_next, Real h, const RestingNodes& resting, Column<ExternalWork>& partial);

}  // namespace skerry
