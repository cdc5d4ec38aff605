// Size and orientation of a tetrahedron.
#pragma once

#include <array>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Six times the rest volume of a tetrahedron with the nodes n0 to n3: det(n1 - n0, n2 - n0, n3 - n0) [m^3].
Real six_volumes(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Lengths of the six edges of a tetrahedron [m].
std::array<Real, 6> edge_lengths(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Returns (2 A)^2, where A is the area of the largest face [m^4]. The smallest altitude is |six_volumes| / (2 A).
Real largest_face_squared(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

enum class Orientation { positive, flat, inverted };

/// Orientation of a tetrahedron. It is flat if |six_volumes| is at most 1e-12 times the cube of its longest edge,
/// because rounding of the coordinates gives a flat tetrahedron a volume of this size.
Orientation orientation(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Throws SceneError unless every tetrahedron has four different existing nodes and every node is finite. The message
/// contains `name`, the name of the file or the body.
void require_valid(const Mesh& mesh, const std::string& name);

}  // namespace skerry::mesh
