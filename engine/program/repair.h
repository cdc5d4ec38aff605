// A better mesh of the same body.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "engine/mesh/repair/surface_distance.h"
#include "engine/program/step_bound.h"

namespace skerry {

/// One side of the table that a repair prints.
struct MeshFigures {
    MeshReport mesh;
    Real surface_area = 0;  // m^2
    Real step = 0;          // s
};

struct RepairedMesh {
    Mesh mesh;
    MeshFigures before, after;
    mesh::SurfaceDistance distance;          // from the old surface to the new one, and back
    Real tolerance = 0;                      // m
    std::size_t collapsed = 0, flipped = 0;  // edges of the surface
    std::size_t parted = 0;                  // nodes that joined tetrahedra which share no face there
    std::string kept;                        // why the tetrahedra are those that there were, but for parted nodes
    std::string refusal;                     // why nothing is to be written; empty: it is better
};

/// Fills the mesh's surface with new tetrahedra, once as it is and once without its knots, as far as that moves it by
/// at most `tolerance` (a share of the bounding box's diagonal; 0: once as it is), and takes the one with the longer
/// step. Nodes that join tetrahedra which share no face there are parted before (part_fans.h); such a mesh is worth
/// having with the tetrahedra that it has, too. `progress` is told what is going on, many times a second. Throws
/// SceneError for a mesh whose surface cannot be filled.
RepairedMesh repair(const Mesh& mesh, const std::string& what, const StepCase& of, Real tolerance,
                    const std::function<void(const std::string&)>& progress);

}  // namespace skerry
