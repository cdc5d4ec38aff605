// Removes needles and caps from a surface: a tetrahedron behind a flat triangle is hardly thicker than the triangle.
#pragma once

#include "skerry/mesh.h"

namespace skerry::mesh {

struct KnotSettings {
    Real tolerance = 0;  // distance the surface may move; above 0 [m]
    Real altitude = 0;   // triangles with a smaller altitude than this are repaired [m]
};

struct ThinnedSurface {
    SurfaceMesh surface;
    std::size_t collapsed = 0, flipped = 0;  // numbers of edges
};

/// Repeatedly takes the flattest triangle with an altitude below `altitude`, and collapses or flips the edge of it
/// that makes the smallest altitude around it largest. Triangles that no change improves are left. The surface is
/// unchanged elsewhere. Every change keeps the topology (link condition: Dey, Edelsbrunner, Guha, Nekhayev, Topology
/// preserving edge contraction, 1999), the orientation of triangles, and both surfaces within the tolerance of each
/// other. The surface must be closed, with two triangles at every edge. Self-intersections are not checked: they do
/// not occur with a tolerance below the thickness of the body. Deterministic.
ThinnedSurface thin_knots(const SurfaceMesh& surface, const KnotSettings& settings);

}  // namespace skerry::mesh
