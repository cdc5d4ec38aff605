// Removes needles and caps (degenerate triangles) from a surface, because a tetrahedron with such a face is hardly
// thicker than the altitude of the face.
#pragma once

#include "skerry/mesh.h"

namespace skerry::mesh {

struct RepairSettings {
    Real tolerance = 0;  // largest distance that the surface may move, > 0 [m]
    Real altitude = 0;   // triangles are repaired if their smallest altitude is less than this [m]
};

struct RepairedSurface {
    SurfaceMesh surface;
    std::size_t collapsed = 0, flipped = 0;  // number of collapsed edges, and number of flipped edges
};

/// Repairs the triangles whose smallest altitude is below `altitude`, the flattest first, by collapsing or flipping one
/// of their edges. The surface must be closed, with two triangles at every edge. The result is deterministic.
///
/// - Choice: the change after which the smallest altitude of the changed triangles is largest. A triangle that no
///   change improves is left.
/// - Every change preserves the orientation of triangles and the topology (link condition: Dey, Edelsbrunner, Guha,
///   Nekhayev, Topology preserving edge contraction, 1999).
/// - The old and the new surface stay within the tolerance of each other. Self-intersections are not checked: they do
///   not occur with a tolerance below the thickness of the body.
RepairedSurface remove_flat_triangles(const SurfaceMesh& surface, const RepairSettings& settings);

}  // namespace skerry::mesh
