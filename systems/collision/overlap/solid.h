// A body, or the surface of a mesh collider, as what it fills.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "systems/collision/overlap/simplex_overlap.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry {

/// A triangle of its boundary, counter-clockwise seen from outside.
struct SolidTriangle {
    std::array<Index, 3> node;
    Index simplex;  // behind it
};

struct Solid {
    std::vector<Vec3> point;                    // m
    std::vector<std::array<Index, 4>> simplex;  // tetrahedra; or triangles, with no_index as their last node
    std::vector<SolidTriangle> surface;
    std::vector<Index> surface_point;  // rows of `point` that it has, ascending
    BoxTree tree;                      // over the simplices
    Aabb box;
    bool has_volume;  // tetrahedra
    bool closed;      // it has an inside

    Simplex at(Index s) const;
};

Solid solid_of_tetrahedra(std::span<const Vec3> point, std::span<const std::array<Index, 4>> tetrahedra,
                          std::vector<SolidTriangle> surface);
/// Of a surface; one that is not closed is all that it fills.
Solid solid_of_surface(std::span<const Vec3> point, std::span<const std::array<Index, 3>> triangles);

/// Whether a point is in a solid, or outside of one with volume by no more than `tolerance` (m). Of a closed surface:
/// whether the surface goes around it, once or more, with its outside away from the point.
bool contains(const Solid& solid, const Vec3& point, Real tolerance);

}  // namespace skerry
