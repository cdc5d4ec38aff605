// Force element: loads on nodes, set by the user.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/executor.h"

namespace skerry {

/// Sets the applied force of every node to its load; other force elements add theirs to it. `load` and `applied_force`:
/// by node [N]. Parallel over nodes.
void add_nodal_loads(Executor& executor, std::span<const Vec3> load, std::span<Vec3> applied_force);

/// After a step: copies the applied forces, by node, for the balance of the next step [N]. Parallel over nodes.
void keep_applied_forces(Executor& executor, std::span<const Vec3> applied_force, std::span<Vec3> applied_before);

}  // namespace skerry
