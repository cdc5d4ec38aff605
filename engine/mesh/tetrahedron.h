// Measures and orientation of one tetrahedron.
#pragma once

#include <array>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Six times the rest volume: det(n1 - n0, n2 - n0, n3 - n0) [m^3].
Real six_volumes(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Lengths of the six edges [m].
std::array<Real, 6> edge_lengths(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// (2 A)^2 with A the area of the largest face [m^4]. The smallest altitude is six_volumes / (2 A).
Real largest_face_squared(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

enum class Orientation { positive, flat, inverted };

/// A tetrahedron is flat if six_volumes is at most 1e-12 of the cube of its longest edge: coordinates of a flat one
/// give that much by rounding.
Orientation orientation(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Throws SceneError unless every tetrahedron has four different existing nodes and every node is finite. `what` names
/// the file or the body in the message.
void require_valid(const Mesh& mesh, const std::string& what);

}  // namespace skerry::mesh
