// Levels of refinement of the meshes of a scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/scene_file.h"

namespace skerry {

/// Largest absolute value of MeshEntry::refine. One tetrahedron becomes 8^6 = 262,144. A larger number is probably a
/// typing mistake.
inline constexpr int most_refinements = 6;

/// A mesh whose refinement changes the results of a scene: that of a deformable body, or a curved built-in shape of a
/// rigid body or a collider. Levels are relative to the scene: at level n the edges are 2^-n times as long.
struct MeshLevels {
    Place place;                    // place of the mesh entry
    int refine = 0;                 // value of the entry in the scene
    int coarsest = 0, finest = 0;   // the levels between these can be assigned
    std::string why_not_coarser{};  // reason for the value of `coarsest`
    std::string why_not_finer{};
};

struct SceneLevels {
    std::vector<MeshLevels> meshes{};
    // Levels that all meshes have; 0 if there are no meshes. Coarser levels never change the triangles of a file. A
    // coarser level of a surface that is filled may still be refused on reading, if no mesher fills it.
    int coarsest = 0, finest = 0;
    std::string why_not_coarser{}, why_not_finer{};  // reasons, each with the name of the mesh

    /// Assignments (assign.h) that bring all meshes to a level.
    std::vector<std::string> assignments(int level) const;
};

/// Finds the possible levels of the meshes of a scene. Meshes of included scenes have only the level 0, because
/// assignments change only the content of the scene file `file`.
SceneLevels levels_of(const SceneFile& scene, const std::filesystem::path& file);

/// Assignments that give all deformable bodies of the file elements of one kind.
std::vector<std::string> element_assignments(const SceneFile& scene, const std::filesystem::path& file,
                                             ElementKind element);

/// Throws SceneError if the value of `refine` of a mesh is impossible for its shape or for the parts that the scene
/// names.
void require_levels(const SceneFile& scene);

}  // namespace skerry
