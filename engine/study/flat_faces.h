// Error of flat faces that approximate a curved surface (docs/methods/study.md 2).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/scene/scene_file.h"
#include "skerry/scene.h"

namespace skerry {

/// Measures for how well the flat faces of a mesh approximate a curved surface.
struct FlatFaces {
    // Mean distance of the flat faces from a smooth surface through their nodes, divided by the radius of curvature of
    // this surface; 0 if no part is curved.
    Real share = 0;
    Real angle = 0;  // largest angle between neighbouring faces of the curved surface [rad]
};

/// Measures the faces of a surface, which need not be closed. Edges at which the normals of the two triangles differ by
/// more than 40 degrees are taken for edges of the body. Only the other edges count as approximations of a curved
/// surface.
FlatFaces flat_faces(std::span<const Vec3> nodes, std::span<const std::array<Index, 3>> triangles);

/// A deformable body whose surface comes from a file. Refinement divides the flat faces of the file, but does not move
/// the new nodes onto the curved surface that the faces approximate.
struct FlatBody {
    std::string name;
    FlatFaces faces;
    bool is_held = false;  // true if the body is pinned and no pin moves, so that all displacements are deformations

    /// Relative error of the displacements and stresses of the body because its faces are flat; 0 unless `is_held`.
    Real error() const;
};
/// Returns the deformable bodies with a curved surface whose mesh is read from a file or fills a surface.
std::vector<FlatBody> flat_bodies(const SceneFile& file, const World& world);

/// Returns the remarks of a study on `bodies`. Bodies with equal remarks share one text.
std::vector<std::string> flat_texts(std::span<const FlatBody> bodies);

}  // namespace skerry
