// The volume that is filled by a body or enclosed by the surface of a mesh collider.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "systems/collision/overlap/simplex_overlap.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry {

/// A triangle on the boundary of a solid, counter-clockwise as seen from outside.
struct SolidTriangle {
    std::array<Index, 3> node;
    Index simplex;  // simplex behind the triangle
};

struct Solid {
    std::vector<Vec3> point;                    // [m]
    std::vector<std::array<Index, 4>> simplex;  // tetrahedra, or triangles with no_index as their last node
    std::vector<SolidTriangle> surface;
    std::vector<Index> surface_point;  // rows of `point` that are on the surface, ascending
    BoxTree tree;                      // over the simplices
    Aabb box;
    bool has_volume;  // true for tetrahedra
    bool closed;      // true if the surface encloses a volume

    Simplex at(Index s) const;
};

Solid solid_of_tetrahedra(std::span<const Vec3> point, std::span<const std::array<Index, 4>> tetrahedra,
                          std::vector<SolidTriangle> surface);
/// Returns the solid inside a surface of triangles. If the surface is not closed, the solid consists of the surface
/// alone.
Solid solid_of_surface(std::span<const Vec3> point, std::span<const std::array<Index, 3>> triangles);

/// True if a point is inside a solid. For a solid of tetrahedra, the point may be outside by up to `tolerance` [m]. A
/// closed surface contains the point if its winding number around the point is at least 1.
bool contains(const Solid& solid, const Vec3& point, Real tolerance);

}  // namespace skerry
