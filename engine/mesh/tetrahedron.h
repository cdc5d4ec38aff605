// Measures of one tetrahedron, and what counts as flat.
#pragma once

#include <array>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Six times the rest volume (m^3): det(n1 - n0, n2 - n0, n3 - n0).
Real six_volumes(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// The six edge lengths (m).
std::array<Real, 6> edge_lengths(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// (2 A)^2 with A the area of the largest face (m^4): the smallest altitude is six volumes over 2 A.
Real largest_face_squared(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

enum class Orientation { positive, flat, inverted };

/// Flat: six volumes are at most 1e-12 of the cube of the longest edge, which is what rounding of the coordinates
/// leaves of none.
Orientation orientation(const Mesh& mesh, const std::array<Index, 4>& tetrahedron);

/// Throws SceneError unless every tetrahedron names four different nodes that exist and every node is finite. `what` is
/// the file or the body that is complained about.
void require_valid(const Mesh& mesh, const std::string& what);

}  // namespace skerry::mesh
