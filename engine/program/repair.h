// Computes a mesh of the same body with a longer stable step.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "engine/program/step_bound.h"
#include "skerry/fill.h"

namespace skerry {

/// Properties of one mesh in the table that a repair prints.
struct MeshFigures {
    MeshReport mesh;
    Real surface_area = 0;  // [m^2]
    Real step = 0;          // stable step [s]
};

struct RepairedMesh {
    Mesh mesh;
    MeshFigures before, after;
    mesh::SurfaceDistance distance;          // distance between the old surface (first) and the new surface (second)
    Real tolerance = 0;                      // largest allowed distance between the two surfaces [m]
    std::size_t collapsed = 0, flipped = 0;  // numbers of surface edges that were collapsed or flipped
    // Number of nodes that were split because some of their tetrahedra were not connected by faces.
    std::size_t parted = 0;
    // If the result is the old mesh with split nodes: reason why its tetrahedra were not replaced. Otherwise empty.
    std::string reason_unchanged;
    std::string refusal;  // reason why the mesh must not be written; otherwise empty
};

/// Fills the surface of the mesh with new tetrahedra, and returns the mesh with the longest stable step.
///
/// 1. Nodes whose tetrahedra are not connected by faces are split (part_fans.h).
/// 2. The unchanged surface is filled.
/// 3. If `tolerance` is above 0, the surface is also filled after removal of its needles and caps (very flat
///    triangles). The removal moves the surface by at most `tolerance`, as a fraction of the diagonal of the bounding
///    box.
/// 4. If no new tetrahedra are better than the old ones but nodes were split, the old tetrahedra are returned with the
///    split nodes.
///
/// Errors name the mesh by `name`. `progress` is called many times a second with a description of the current activity.
/// Throws SceneError if the boundary of the mesh is not a closed manifold, or if the mesh has several labels or
/// unconnected parts.
RepairedMesh repair(const Mesh& mesh, const std::string& name, const BodyCase& body_case, Real tolerance,
                    const std::function<void(const std::string&)>& progress);

}  // namespace skerry
