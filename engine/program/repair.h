// Computes a better mesh of the same body.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "engine/mesh/repair/surface_distance.h"
#include "engine/program/step_bound.h"

namespace skerry {

/// Figures of one mesh in the table that a repair prints.
struct MeshFigures {
    MeshReport mesh;
    Real surface_area = 0;  // [m^2]
    Real step = 0;          // stable step [s]
};

struct RepairedMesh {
    Mesh mesh;
    MeshFigures before, after;
    mesh::SurfaceDistance distance;          // from the old surface to the new one, and back
    Real tolerance = 0;                      // [m]
    std::size_t collapsed = 0, flipped = 0;  // numbers of surface edges
    std::size_t parted = 0;                  // number of nodes split because their tetrahedra share no face there
    std::string kept;                        // reason why the old tetrahedra are kept, apart from split nodes
    std::string refusal;                     // reason why the mesh is not to be written; empty: it is better
};

/// Fills the mesh's surface with new tetrahedra and returns the mesh with the longest stable step. The surface is
/// tried as it is and without its knots (needles and caps). Removing them moves it by at most `tolerance`, a share of
/// the bounding box's diagonal; 0: only as it is. First, nodes whose tetrahedra share no face there are split
/// (part_fans.h); a mesh with split nodes is accepted even with its old tetrahedra. `progress` is called with the
/// current activity many times a second. Throws SceneError for a mesh whose surface cannot be filled.
RepairedMesh repair(const Mesh& mesh, const std::string& what, const StepCase& of, Real tolerance,
                    const std::function<void(const std::string&)>& progress);

}  // namespace skerry
