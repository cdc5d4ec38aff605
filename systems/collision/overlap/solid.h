// The volume of a body, or the volume enclosed by the surface of a mesh collider.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "systems/collision/overlap/simplex_overlap.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry {

/// A triangle on the boundary of a solid, with corners counter-clockwise as seen from outside.
struct SolidTriangle {
    std::array<Index, 3> node;
    Index simplex;  // the simplex to which the triangle belongs
};

struct Solid {
    std::vector<Vec3> point;  // [m]
    // Indices of the points of each simplex: four for a tetrahedron; three for a triangle, with no_index as fourth.
    std::vector<std::array<Index, 4>> simplex;
    std::vector<SolidTriangle> surface;
    std::vector<Index> surface_point;  // indices of the points that are on the surface, ascending
    BoxTree tree;                      // tree over the boxes of the simplices
    Aabb box;
    bool has_volume;  // true: the simplices are tetrahedra
    bool closed;      // true: the surface encloses a volume

    Simplex at(Index s) const;
};

Solid solid_of_tetrahedra(std::span<const Vec3> point, std::span<const std::array<Index, 4>> tetrahedra,
                          std::vector<SolidTriangle> surface);
/// Returns the solid enclosed by a surface of triangles. If the surface is not closed, the solid consists of the
/// surface alone.
Solid solid_of_surface(std::span<const Vec3> point, std::span<const std::array<Index, 3>> triangles);

/// True if a point is inside a solid:
/// - A solid of tetrahedra also contains points that are outside by at most `tolerance` [m].
/// - A closed surface contains a point if the winding number around the point is at least 1; `tolerance` is not used.
/// - An open surface contains no point.
bool contains(const Solid& solid, const Vec3& point, Real tolerance);

}  // namespace skerry
