// The command `skerry inspect --repair`.
#pragma once

#include "engine/program/commands.h"
#include "engine/program/step_bound.h"

namespace skerry {

/// A mesh to repair, and the properties of the body for which the stable step is computed.
struct RepairTask {
    const Mesh& mesh;
    std::string name;  // name of the mesh in messages: the mesh file, or the scene and the body
    BodyCase body_case;
    std::string step_of;  // description of the material for which the stable step is computed
    // true if the scene scales the mesh: the repaired file contains scaled nodes, so `scale` must be removed from the
    // scene
    bool scaled = false;
};

/// Checks the options before any computation: the output file is a writable .msh file, it does not replace the input
/// file without --overwrite, and skerry-fill, the program that fills surfaces, exists. Throws SceneError otherwise.
void check_repair(const InspectOptions& options);

/// Repairs the mesh, prints the properties of the old and the new mesh, and writes the new mesh if it is better.
/// Returns the exit code of the program.
int inspect_repair(const RepairTask& task, const InspectOptions& options);

}  // namespace skerry
