// Meshes of the bodies and colliders of a scene.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Settings for filling surfaces. `progress`: is called with a text on the activity. `python`: see mesh::FillSettings.
struct SurfaceFilling {
    const mesh::FillProgress& progress;
    const std::string& python;
};

/// Makes the mesh of an entry, with its scale and refinement. `rigid`: true if the mesh may be a surface without
/// tetrahedra. Remarks about the mesh file are appended to `notes`. Throws SceneError.
PlannedMesh make_mesh(const MeshEntry& entry, bool rigid, std::vector<std::string>& notes,
                      const SurfaceFilling& filling);

/// Makes the surface of a mesh collider.
SurfaceMesh make_surface(const MeshEntry& entry, std::vector<std::string>& notes, const SurfaceFilling& filling);

}  // namespace skerry
