#include "systems/dynamics/clusters/arm_guards.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "systems/dynamics/clusters/chain_nodes.h"

namespace skerry {

namespace {

// Assumed modulus (stiffness that the implicit integration assumes) of a newly activated inversion barrier (guard),
// divided by the stiffness k of the barrier (docs/methods/elasticity.md 7.7). It is so small that the added inertia is
// negligible until the guard is compressed.
constexpr Real modulus_at_rest = 0.01;

/// True if a tetrahedron has moving corners and all its moving corners belong to one cluster.
bool in_one_cluster(ConnectedNodes& connected, const BlockNodes& nodes, std::size_t lane,
                    std::span<const Real> inverse_mass) {
    Index root = no_index;
    for (Index k = 0; k < nodes.count; ++k) {
        const Index node = nodes.node[k][lane];
        if (!(inverse_mass[static_cast<std::size_t>(node)] > 0)) continue;
        const Index own = connected.root_of(node);
        if (own == no_index || (root != no_index && own != root)) return false;
        root = own;
    }
    return root != no_index;
}

/// Volume V of a tetrahedron [m^3]; 0 in an unused lane. The determinant of three of its shape gradients is 1/(6 V).
Real volume_of(const BlockNodes& nodes, std::size_t l) {
    Mat3 gradients;
    for (Index k = 1; k < 4; ++k)
        gradients.col(k - 1) = Vec3(nodes.gradient[k][0][l], nodes.gradient[k][1][l], nodes.gradient[k][2][l]);
    const Real determinant = std::abs(gradients.determinant());
    return determinant > 0 ? 1 / (6 * determinant) : 0;
}

}  // namespace

void arm_guards(const ElementInputs& elements, Range blocks, std::span<const Real> inverse_mass,
                const GuardOutputs& out) {
    const auto parts =
        elements.part.subspan(static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size()));
    if (std::ranges::find(parts, ElementPart::guard) == parts.end()) return;
    ConnectedNodes connected(elements, blocks, out.modulus, inverse_mass);
    for (std::size_t row = 0; row < parts.size(); ++row) {
        if (parts[row] != ElementPart::guard) continue;
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + row;
        const BlockNodes nodes = elements.nodes_of(b);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real volume = volume_of(nodes, l);
            const bool acts = volume > 0 && in_one_cluster(connected, nodes, l, inverse_mass);
            out.volume[row][l] = acts ? volume : 0;
            out.modulus[row][l] =
                acts ? std::max(out.modulus[row][l], modulus_at_rest * elements.material_of(b).lame_lambda) : 0;
        }
    }
}

void disarm_guards(std::span<const ElementPart> part, std::span<ElementLane> volume) {
    for (std::size_t b = 0; b < part.size(); ++b)
        if (part[b] == ElementPart::guard) volume[b] = {};
}

}  // namespace skerry
