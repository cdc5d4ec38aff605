// `skerry inspect --repair`.
#pragma once

#include "engine/program/commands.h"
#include "engine/program/step_bound.h"

namespace skerry {

/// A mesh that is to be mended, and what it is for.
struct RepairTask {
    const Mesh& mesh;
    std::string what;  // the file, or the body of a scene
    StepCase of;
    std::string step_of;  // what the steps that are printed are of
    bool scaled = false;  // by a scene: the file that is written is not to be scaled again
};

/// Says before any work what stands in the way: the name of the file, skerry-fill, the input itself. Throws SceneError.
void check_repair(const InspectOptions& options);

/// Mends the mesh, prints both sides, writes the new one if it is better. Returns the exit code.
int inspect_repair(const RepairTask& task, const InspectOptions& options);

}  // namespace skerry
