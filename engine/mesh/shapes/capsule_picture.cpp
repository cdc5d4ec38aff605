#include <cmath>
#include <numbers>

#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {
namespace {

// Number of nodes around the axis, and number of rings of nodes of each round end. The rim counts as a ring, the pole
// does not.
constexpr int around = 16, caps = 4;

/// Builds a capsule from two round ends and a straight part. The tetrahedra of a round end meet at the centre of its
/// hemisphere. The straight part consists of wedges between the axis and the surface.
class CapsuleBuilder {
public:
    CapsuleBuilder(Real radius, Real length) : radius_(radius), half_(length / 2) {}

    Mesh build() {
        for (const Real up : {-1.0, 1.0}) mesh_.nodes.emplace_back(0, 0, up * half_);
        // The first nodes are the two centres, then the pole and four nodes of the rim of each end. Their numbers are
        // fixed, so that users can refer to these nodes, for example to show the rotation of the body.
        for (const int end : {0, 1}) {
            row_[end][caps][0] = add(end, caps, 0);
            for (int k = 0; k < around; k += around / 4) row_[end][0][k] = add(end, 0, k);
        }
        for (const int end : {0, 1}) {
            for (int ring = 0; ring < caps; ++ring)
                for (int k = 0; k < around; ++k)
                    if (ring > 0 || k % (around / 4) != 0) row_[end][ring][k] = add(end, ring, k);
            for (int k = 0; k < around; ++k) fill_cap(end, k);
        }
        for (int k = 0; k < around; ++k) fill_wedge(k);
        return std::move(mesh_);
    }

private:
    Index add(int end, int ring, int k) {
        const Real up = ring * std::numbers::pi / (2 * caps), turn = 2 * std::numbers::pi * k / around,
                   out = ring == caps ? 0 : radius_ * std::cos(up), height = half_ + radius_ * std::sin(up);
        mesh_.nodes.emplace_back(out * std::cos(turn), out * std::sin(turn), end == 0 ? -height : height);
        return static_cast<Index>(mesh_.nodes.size()) - 1;
    }
    Index row(int end, int ring, int k) const { return row_[end][ring][ring == caps ? 0 : k % around]; }

    void fill_cap(int end, int k) {
        for (int ring = 0; ring < caps; ++ring) {
            add_tetrahedron(mesh_, {end, row(end, ring, k), row(end, ring, k + 1), row(end, ring + 1, k)});
            if (ring + 1 < caps)
                add_tetrahedron(mesh_, {end, row(end, ring, k + 1), row(end, ring + 1, k), row(end, ring + 1, k + 1)});
        }
    }
    /// Fills a wedge with three tetrahedra. The diagonals of its sides run from the lower end of the axis to the upper
    /// rim, so that neighbouring wedges match.
    void fill_wedge(int k) {
        const Index a = row(0, 0, k), b = row(0, 0, k + 1), c = row(1, 0, k), d = row(1, 0, k + 1);
        add_tetrahedron(mesh_, {0, a, b, d});
        add_tetrahedron(mesh_, {0, a, c, d});
        add_tetrahedron(mesh_, {0, 1, c, d});
    }

    const Real radius_, half_;  // [m]
    Mesh mesh_;
    Index row_[2][caps + 1][around] = {};
};

}  // namespace

Mesh capsule_picture(Real radius, Real length) {
    require_size("capsule", "radius", radius);
    require_size("capsule", "length", length);
    return CapsuleBuilder(radius, length).build();
}

}  // namespace skerry::mesh
