// Helper functions of the built-in shapes: checks of parameters, and tetrahedra with positive orientation.
#pragma once

#include <array>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Appends a tetrahedron with the given nodes, ordered so that its volume is positive.
void add_tetrahedron(Mesh& mesh, std::array<Index, 4> nodes);

/// require_size throws SceneError unless the size is finite and positive, require_count unless the count is at least 1.
void require_size(const char* shape, const char* field, Real value);
void require_count(const char* shape, const char* field, int value);

/// Throws SceneError if a mesh is too large for 32-bit indices: tables of corners have four entries per tetrahedron.
void require_fits(const char* shape, const char* field, double tetrahedra);

}  // namespace skerry::mesh
