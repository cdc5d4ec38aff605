// Force element (part of a step that adds forces to nodes): loads that the user has set on single nodes.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/executor.h"

namespace skerry {

/// Sets the applied force of every node to the load on the node. The function runs first; all other force elements then
/// add their forces. `load` and `applied_force`: by node [N]. Parallel over nodes.
void add_nodal_loads(Executor& executor, std::span<const Vec3> load, std::span<Vec3> applied_force);

/// Copies the applied forces after a step, by node, because the energy balance of the next step needs them [N].
/// Parallel over nodes.
void keep_applied_forces(Executor& executor, std::span<const Vec3> applied_force, std::span<Vec3> applied_before);

}  // namespace skerry
