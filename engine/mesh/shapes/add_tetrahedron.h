// What the built-in shapes share: checks of what was asked for, and a tetrahedron the right way round.
#pragma once

#include <array>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Appends a tetrahedron of the given nodes, in an order that makes it positive.
void add_tetrahedron(Mesh& mesh, std::array<Index, 4> nodes);

/// Throw std::invalid_argument that names what is wrong. A size has to be finite and positive, a count at least 1.
void require_size(const char* name, Real value);
void require_count(const char* name, int value);

/// Throws std::invalid_argument when so many tetrahedra would not fit a 32-bit index (four a tetrahedron).
void require_fits(const char* name, double tetrahedra);

}  // namespace skerry::mesh
