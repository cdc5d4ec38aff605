// Random meshes of the qualities that people's own meshes have: slivers, moved nodes, cells that shrink towards a
// corner, needles.
#pragma once

#include "random_numbers.h"
#include "skerry/mesh.h"

namespace skerry::test {

/// A block about as large as `size` (m), its middle at the origin, of at most some thousand tetrahedra, all of positive
/// volume. The flattest have from a third to a thousandth of the altitude that they would have in an even mesh.
Mesh make_poor_mesh(RandomNumbers& random, Real size);

}  // namespace skerry::test
