// Random meshes with the defects of real users' meshes: slivers, moved nodes, cells that shrink towards a corner,
// needles.
#pragma once

#include "random_numbers.h"
#include "skerry/mesh.h"

namespace skerry::test {

/// A block of about `size` [m] with its middle at the origin. It has at most a few thousand tetrahedra, all of positive
/// volume. The flattest have from a third to a thousandth of the altitude that they would have in an even mesh.
Mesh make_poor_mesh(RandomNumbers& random, Real size);

}  // namespace skerry::test
