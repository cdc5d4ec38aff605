// The command `skerry inspect --repair`.
#pragma once

#include "engine/program/commands.h"
#include "engine/program/step_bound.h"

namespace skerry {

/// A mesh to repair and its use.
struct RepairTask {
    const Mesh& mesh;
    std::string what;  // the file, or the body of a scene
    StepCase of;
    std::string step_of;  // description of the body whose steps are printed
    bool scaled = false;  // the scene has scaled the mesh: the written file must not be scaled again
};

/// Checks before any work starts: the file name, skerry-fill and the input. Throws SceneError.
void check_repair(const InspectOptions& options);

/// Repairs the mesh, prints the figures of both meshes and writes the new one if it is better. Returns the exit code.
int inspect_repair(const RepairTask& task, const InspectOptions& options);

}  // namespace skerry
