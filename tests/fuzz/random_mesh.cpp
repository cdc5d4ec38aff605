#include "random_mesh.h"

#include <cmath>

#include "tests/support/jittered_box.h"
#include "tests/support/sliver_box.h"

namespace skerry::test {

namespace {

/// A box with moved nodes, also on the surface; some tetrahedra become nearly flat.
Mesh moved_nodes(RandomNumbers& random, Real size) {
    const std::array<Index, 3> cells{random.count(1, 4), random.count(1, 4), random.count(1, 4)};
    const Real edge = size / static_cast<Real>(std::max({cells[0], cells[1], cells[2]}));
    const TetMesh box =
        jittered_box(cells, edge, random.within(0.05, 0.45), random.next(), random.by_decade(1e-3, 0.3));
    Mesh mesh;
    mesh.nodes = box.nodes;
    mesh.tetrahedra = box.tetrahedra;
    const Vec3 middle = edge / 2 * Vec3(cells[0], cells[1], cells[2]);
    for (Vec3& x : mesh.nodes) x -= middle;
    return mesh;
}

/// A box whose cells shrink towards one corner, at a different rate in each direction.
Mesh graded(RandomNumbers& random, Real size) {
    Mesh mesh = mesh::box(Vec3::Ones(), {random.count(2, 5), random.count(2, 5), random.count(2, 5)});
    const Vec3 power(random.within(1, 3), random.within(1, 3), random.within(1, 3));
    for (Vec3& x : mesh.nodes)
        for (Index i = 0; i < 3; ++i)
            // Rounding may leave a node slightly below the lower face.
            x[i] = size * (std::pow(std::max(Real(0), x[i] + Real(0.5)), power[i]) - Real(0.5));
    return mesh;
}

/// Needles or plates that are one cell thick.
Mesh slender(RandomNumbers& random, Real size) {
    const Real thin = random.by_decade(0.01, 0.2);
    const bool plate = random.chance(0.5);
    return mesh::box(size * Vec3(1, plate ? random.within(0.5, 1) : thin, thin),
                     {random.count(1, 6), plate ? random.count(1, 6) : 1, 1});
}

}  // namespace

Mesh make_poor_mesh(RandomNumbers& random, Real size) {
    switch (random.count(0, 3)) {
        case 0:
            return sliver_box(size, random.count(2, 5), random.by_decade(0.003, 0.2), random.by_decade(1e-3, 0.3),
                              random.next());
        case 1:
            return moved_nodes(random, size);
        case 2:
            return graded(random, size);
        default:
            return slender(random, size);
    }
}

}  // namespace skerry::test
