// Levels of refinement of the meshes of a scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/scene_file.h"

namespace skerry {

/// Largest absolute value of MeshEntry::refine. With this value one tetrahedron becomes 8^6 = 262,144. A larger value
/// is probably a typing mistake.
inline constexpr int most_refinements = 6;

/// The possible levels of a mesh whose refinement changes the results of a scene: the mesh of a deformable body, or a
/// curved built-in shape of a rigid body or a collider. At level n the edges are 2^-n times as long as in the scene
/// file.
struct MeshLevels {
    Place place;                    // place of the mesh entry
    int refine = 0;                 // value of the key `refine` in the scene file
    int coarsest = 0, finest = 0;   // lowest and highest level that can be assigned
    std::string why_not_coarser{};  // reason why no level below `coarsest` is possible
    std::string why_not_finer{};
};

struct SceneLevels {
    std::vector<MeshLevels> meshes{};
    // Lowest and highest level that all meshes have; 0 if there are no meshes. Meshes that cannot be coarsened, which
    // are mesh files and surfaces filled without `edge`, have no level below 0. At such a level, reading a scene whose
    // surface is filled with `edge` may fail, because no mesher can fill it so coarsely.
    int coarsest = 0, finest = 0;
    std::string why_not_coarser{}, why_not_finer{};  // reasons, each with the place of the mesh

    /// Assignments (assign.h) that bring all meshes to a level.
    std::vector<std::string> assignments(int level) const;
};

/// Finds the possible levels of the meshes of a scene. Meshes of included scenes have only the level 0, because
/// assignments change only the content of the scene file `file`.
SceneLevels levels_of(const SceneFile& scene, const std::filesystem::path& file);

/// Assignments that set the kind of element of all deformable bodies in the scene file `file`.
std::vector<std::string> element_assignments(const SceneFile& scene, const std::filesystem::path& file,
                                             ElementKind element);

/// Throws SceneError if the value of `refine` of a mesh is impossible for its kind of mesh, or if the scene names nodes
/// or sets that the refined mesh would not have.
void require_levels(const SceneFile& scene);

}  // namespace skerry
