// Visual surfaces: fine triangle surfaces that are drawn in place of the bodies that they follow.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// Colour, opacity and texture of triangles of a visual surface.
struct VisualMaterial {
    std::string name;                          // name in the file
    std::array<Real, 3> color{0.8, 0.8, 0.8};  // red, green and blue of sRGB, each in [0, 1]
    Real opacity = 1;                          // in [0, 1]
    std::string texture{};                     // path of the image that replaces the colour; empty: none

    bool operator==(const VisualMaterial&) const = default;
};

/// A triangle surface that is drawn in place of a body. It may be open or cross itself, because no step uses it.
struct VisualSurface {
    std::vector<Vec3> nodes{};                          // nodes in the frame of the body's mesh [m]
    std::vector<std::array<Index, 3>> triangles{};      // indices of `nodes`, counter-clockwise as seen from outside
    std::vector<std::array<Real, 2>> texture_points{};  // texture coordinates (u, v)
    // Indices of `texture_points` for the corners of each triangle. All three are no_index for a triangle without
    // texture. The list is empty if no triangle has a texture.
    std::vector<std::array<Index, 3>> texture_corners{};
    std::vector<VisualMaterial> materials{};  // materials of the triangles
    // Index in `materials` for each triangle, or no_index. The list is empty if `materials` is empty.
    std::vector<Index> material{};
    std::string file{};  // file from which the surface was read; empty: none

    bool operator==(const VisualSurface&) const = default;
};

namespace mesh {

/// Reads a visual surface from a file in one of the formats of `read_surface`. Throws SceneError for invalid files.
///
/// From .ply and Wavefront .obj files it also takes texture coordinates. The line `mtllib` of an .obj file names .mtl
/// files, whose lines newmtl, Kd, d, Tr and map_Kd give materials. `notes`, if given, gets a sentence for each missing
/// .mtl file, and for each material that no file defines.
VisualSurface read_visual(const std::string& path, std::vector<std::string>* notes = nullptr);

}  // namespace mesh

/// Distances between a visual surface and its body, both in their rest shapes.
struct VisualFit {
    std::size_t outside = 0;  // number of nodes of the visual surface outside of the body
    Real farthest = 0;        // largest distance of these nodes from the body [m]
    // Warning that distances or sizes suggest a wrong unit or a wrong position of the surface; empty if they do not.
    std::string warning{};
};

/// A view of the visual surfaces of the bodies of a world. It is valid until the world is moved or destroyed. Visual
/// surfaces are saved, cloned and removed with their bodies. Steps do not depend on them, so they are not part of
/// state_hash(). Functions throw SceneError if a handle is stale.
///
/// Each node of the surface follows the nearest point of the body. A node outside of the body also has an offset from
/// this point, which rotates and stretches with the body: by the mean deformation gradient of the tetrahedra around the
/// point. The surface therefore reproduces affine motions exactly, and stays connected.
class Visuals {
public:
    /// `world` must exist as long as the view.
    explicit Visuals(World& world) : world_(&world) {}

    /// Gives a body a visual surface, which replaces an earlier one. Throws SceneError that names the field if an index
    /// is out of range or a position is not finite.
    VisualFit set(BodyHandle body, VisualSurface surface);
    /// Removes the visual surface of a body, which is then drawn by its own surface.
    void remove(BodyHandle body);
    /// Visual surface of a body; nullptr if it has none. The pointer is valid until the surface is set or removed.
    const VisualSurface* get(BodyHandle body) const;
    /// Distances between the visual surface and its body. Throws SceneError if the body has no visual surface.
    VisualFit fit(BodyHandle body) const;
    /// Present positions of the nodes of the visual surface [m]; empty if the body has none.
    std::vector<Vec3> positions(BodyHandle body) const;

private:
    World* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
