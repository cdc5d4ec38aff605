#include "engine/mesh/shapes/stack_discs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/check.h"
#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {
namespace {

// Numbering of the nodes of a disc: the centre, then ring after ring, each counter-clockwise from the x axis. The
// number of a node does not depend on the number of rings, so node n of a disc lies above node n of the disc below.
int ring_begin(int ring) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1);
}
int node_on_ring(int ring, int ring_index) {
    return ring == 0 ? 0 : ring_begin(ring) + ring_index % (6 * ring);
}
int disc_size(int rings) {
    return ring_begin(rings + 1);
}

/// Colours the nodes of a disc with three colours so that neighbouring nodes differ. The colours of the two lower nodes
/// of a wall (rectangular side face of a prism) determine its diagonal, so the prisms on both sides of it agree. All
/// six sectors are treated alike, so the mesh does not favour one sense of rotation.
std::vector<int> paint_nodes(int rings) {
    constexpr std::array<std::array<int, 2>, 6> direction{{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};
    std::vector<int> colour(static_cast<std::size_t>(disc_size(rings)), 0);
    for (int ring = 1; ring <= rings; ++ring)
        for (int ring_index = 0; ring_index < 6 * ring; ++ring_index) {
            const auto sector = static_cast<std::size_t>(ring_index / ring);
            const std::array<int, 2>&out = direction[sector], &along = direction[(sector + 2) % 6];
            // The nodes are connected as in a hexagon cut out of the triangular lattice with the axes p and q. In this
            // lattice, (p - q) mod 3 differs between neighbours.
            const int p = ring * out[0] + ring_index % ring * along[0],
                      q = ring * out[1] + ring_index % ring * along[1];
            colour[static_cast<std::size_t>(node_on_ring(ring, ring_index))] = ((p - q) % 3 + 3) % 3;
        }
    return colour;
}

/// Visits the triangles between two neighbouring rings. `wide` gets the triangles with an edge on the outer ring
/// (outer, outer, inner), `narrow` those with an edge on the inner ring (inner, inner, outer).
template <class Wide, class Narrow>
void for_each_triangle(int ring, Wide&& wide, Narrow&& narrow) {
    for (int sector = 0; sector < 6; ++sector)
        for (int j = 0; j < ring; ++j) {
            const int outer = node_on_ring(ring, sector * ring + j),
                      outer_next = node_on_ring(ring, sector * ring + j + 1);
            const int inner = node_on_ring(ring - 1, sector * (ring - 1) + j);
            wide(outer, outer_next, inner);
            if (j + 1 < ring) narrow(inner, node_on_ring(ring - 1, sector * (ring - 1) + j + 1), outer_next);
        }
}

class DiscStacker {
public:
    explicit DiscStacker(const std::vector<Disc>& discs) : discs_(discs) {
        int most = 0;
        for (const Disc& disc : discs_) most = std::max(most, disc.rings);
        colour_ = paint_nodes(most);
    }

    Mesh build() {
        for (const Disc& disc : discs_) add_nodes(disc);
        for (std::size_t layer = 0; layer + 1 < discs_.size(); ++layer) fill_layer(layer);
        return std::move(mesh_);
    }

private:
    void add_nodes(const Disc& disc) {
        first_.push_back(static_cast<Index>(mesh_.nodes.size()));
        mesh_.nodes.emplace_back(0, 0, disc.z);
        for (int ring = 1; ring <= disc.rings; ++ring)
            for (int ring_index = 0; ring_index < 6 * ring; ++ring_index) {
                const Real angle = 2 * std::acos(Real{-1}) * ring_index / (6 * ring),
                           radius = disc.radius * ring / disc.rings;
                mesh_.nodes.emplace_back(radius * std::cos(angle), radius * std::sin(angle), disc.z);
            }
    }

    void fill_layer(std::size_t layer) {
        const int below = discs_[layer].rings, above = discs_[layer + 1].rings, shared = std::min(below, above);
        SKERRY_CHECK(std::abs(below - above) <= 1 && std::max(below, above) > 0);
        for (int ring = 1; ring <= shared; ++ring) {
            const auto prism = [&](int a, int b, int c) { add_prism(layer, {a, b, c}); };
            for_each_triangle(ring, prism, prism);
        }
        if (below == above) return;
        // The wider disc has one more ring. The space between this ring and the rim of the narrower disc gets a
        // tetrahedron for each triangle with an edge on the ring, and a pyramid for each other triangle.
        const std::size_t wide = below > above ? layer : layer + 1, narrow = below > above ? layer + 1 : layer;
        for_each_triangle(
            shared + 1,
            [&](int a, int b, int inner) {
                add_tetrahedron(mesh_, {node(wide, a), node(wide, b), node(wide, inner), node(narrow, inner)});
            },
            [&](int a, int b, int outer) { add_pyramid(layer, a, b, node(wide, outer)); });
    }

    /// True if the diagonal of a wall (rectangular side face of a prism) rises from `from` to `to`, the lower edge of
    /// the wall. In even layers it rises towards the node of higher colour, in odd layers towards the node of lower
    /// colour.
    bool diagonal_rises(std::size_t layer, int from, int to) const {
        return (colour_[static_cast<std::size_t>(from)] < colour_[static_cast<std::size_t>(to)]) == (layer % 2 == 0);
    }

    void add_prism(std::size_t layer, std::array<int, 3> n) {
        std::sort(n.begin(), n.end(), [&](int a, int b) { return diagonal_rises(layer, a, b); });
        for (std::size_t step = 0; step < 3; ++step) {
            std::array<Index, 4> nodes;
            for (std::size_t a = 0; a <= step; ++a) nodes[a] = node(layer, n[a]);
            for (std::size_t a = step; a < 3; ++a) nodes[a + 1] = node(layer + 1, n[a]);
            add_tetrahedron(mesh_, nodes);
        }
    }

    /// Adds a pyramid as two tetrahedra. Its base is the wall (rectangular side face of a prism) over nodes a and b,
    /// and its apex is the node `tip`.
    void add_pyramid(std::size_t layer, int a, int b, Index tip) {
        if (!diagonal_rises(layer, a, b)) std::swap(a, b);
        add_tetrahedron(mesh_, {node(layer, a), node(layer, b), node(layer + 1, b), tip});
        add_tetrahedron(mesh_, {node(layer, a), node(layer + 1, a), node(layer + 1, b), tip});
    }

    Index node(std::size_t disc, int number) const { return first_[disc] + number; }

    const std::vector<Disc>& discs_;
    std::vector<int> colour_;
    std::vector<Index> first_;  // index of node 0 of each disc
    Mesh mesh_;
};

}  // namespace

Mesh stack_discs(const std::vector<Disc>& discs) {
    return DiscStacker(discs).build();
}

}  // namespace skerry::mesh
