// A body, or the surface of a mesh collider, as the volume it fills.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "systems/collision/overlap/simplex_overlap.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry {

/// A triangle of the boundary, counter-clockwise as seen from outside.
struct SolidTriangle {
    std::array<Index, 3> node;
    Index simplex;  // the one behind the triangle
};

struct Solid {
    std::vector<Vec3> point;                    // [m]
    std::vector<std::array<Index, 4>> simplex;  // tetrahedra; or triangles, with no_index as their last node
    std::vector<SolidTriangle> surface;
    std::vector<Index> surface_point;  // rows of `point` on the surface, ascending
    BoxTree tree;                      // over the simplices
    Aabb box;
    bool has_volume;  // true for tetrahedra
    bool closed;      // true if it has an inside

    Simplex at(Index s) const;
};

Solid solid_of_tetrahedra(std::span<const Vec3> point, std::span<const std::array<Index, 4>> tetrahedra,
                          std::vector<SolidTriangle> surface);
/// Solid of a surface. If the surface is not closed, the solid is the surface alone.
Solid solid_of_surface(std::span<const Vec3> point, std::span<const std::array<Index, 3>> triangles);

/// True if a point is in a solid, or outside of one with volume by no more than `tolerance` [m]. A closed surface
/// contains the point if it goes around the point once or more, with its outside away from the point.
bool contains(const Solid& solid, const Vec3& point, Real tolerance);

}  // namespace skerry
