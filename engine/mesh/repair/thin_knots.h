// A surface without its needles and caps: no tetrahedron behind a flat triangle is much thicker than that.
#pragma once

#include "skerry/mesh.h"

namespace skerry::mesh {

struct KnotSettings {
    Real tolerance = 0;  // m, > 0: how far the surface may move
    Real altitude = 0;   // m: triangles whose smallest altitude is less are mended
};

struct ThinnedSurface {
    SurfaceMesh surface;
    std::size_t collapsed = 0, flipped = 0;  // edges
};

/// Takes the flattest triangle again and again, and collapses or flips that edge of it which makes the smallest
/// altitude around it largest, as long as there are triangles below `altitude` for which that helps. The surface stays
/// as it is elsewhere. Every change keeps points of the old surface within the tolerance of the new one and the other
/// way round, keeps what side triangles look to, and the topology (link condition: Dey, Edelsbrunner, Guha, Nekhayev,
/// Topology preserving edge contraction, 1999). The surface is closed, and every edge has two triangles. It does not
/// look for triangles that come to cut each other, which within a tolerance below the thickness of the body they do
/// not. Deterministic.
ThinnedSurface thin_knots(const SurfaceMesh& surface, const KnotSettings& settings);

}  // namespace skerry::mesh
