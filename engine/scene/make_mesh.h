// Meshes of the bodies and colliders of a scene.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Settings for filling surfaces with tetrahedra. `progress`: function that is called with a description of the current
/// activity. `python`: Python interpreter for the mesher, see mesh::FillSettings.
struct SurfaceFilling {
    const mesh::FillProgress& progress;
    const std::string& python;
};

/// Makes the mesh of an entry, scaled and refined as the entry prescribes. `rigid`: true if the mesh may be a surface
/// without tetrahedra. Remarks about the mesh file are appended to `notes`. Throws SceneError.
PlannedMesh make_mesh(const MeshEntry& entry, bool rigid, std::vector<std::string>& notes,
                      const SurfaceFilling& filling);

/// Makes the surface of a mesh collider.
SurfaceMesh make_surface(const MeshEntry& entry, std::vector<std::string>& notes, const SurfaceFilling& filling);

}  // namespace skerry
