#include "systems/dynamics/clusters/arm_guards.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "components/union_find.h"

namespace skerry {

namespace {

// Of the modulus of a guard, until it comes into play: its inertia is to be next to none at ordinary strain.
constexpr Real modulus_at_rest = 0.01;

/// The clusters of a body, by what chains them.
class Chains {
public:
    Chains(const ElementInputs& elements, Range blocks, std::span<const Real> inverse_mass,
           std::span<const ElementLane> modulus)
        : inverse_mass_(inverse_mass) {
        // the nodes of a body lie side by side
        Index last = -1;
        first_ = std::numeric_limits<Index>::max();
        const auto for_each_node = [&](auto&& visit) {
            for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
                const BlockNodes nodes = elements.nodes_of(b);
                for (std::size_t l = 0; l < element_lanes; ++l)
                    for (Index k = 0; k < nodes.count; ++k) visit(b, l, k, nodes);
            }
        };
        for_each_node([&](std::size_t, std::size_t l, Index k, const BlockNodes& nodes) {
            first_ = std::min(first_, nodes.node[k][l]);
            last = std::max(last, nodes.node[k][l]);
        });
        if (last < first_) return;
        sets_.start(static_cast<std::size_t>(last - first_) + 1);
        chained_.resize(static_cast<std::size_t>(last - first_) + 1);
        Index before = no_index;
        for_each_node([&](std::size_t b, std::size_t l, Index k, const BlockNodes& nodes) {
            if (k == 0) before = no_index;
            if (elements.part[b] == ElementPart::guard) return;
            if (!(modulus[b - static_cast<std::size_t>(blocks.begin)][l] > 0)) return;
            const ElementGradient& g = nodes.gradient[k];
            const Index node = nodes.node[k][l];
            if (!moves(node) || (g[0][l] == 0 && g[1][l] == 0 && g[2][l] == 0)) return;
            chained_[static_cast<std::size_t>(node - first_)] = 1;
            if (before != no_index) sets_.join(before - first_, node - first_);
            before = node;
        });
    }

    /// Whether the moving corners of a tetrahedron are of one cluster, and there are any.
    bool holds(const BlockNodes& nodes, std::size_t lane) {
        Index root = no_index;
        for (Index k = 0; k < nodes.count; ++k) {
            const Index node = nodes.node[k][lane];
            if (!moves(node)) continue;
            if (chained_[static_cast<std::size_t>(node - first_)] == 0) return false;
            const Index own = sets_.root(node - first_);
            if (root != no_index && own != root) return false;
            root = own;
        }
        return root != no_index;
    }

private:
    bool moves(Index node) const { return inverse_mass_[static_cast<std::size_t>(node)] > 0; }

    std::span<const Real> inverse_mass_;
    Index first_ = 0;
    UnionFind sets_;
    std::vector<std::uint8_t> chained_;  // by node of the body
};

/// m^3, by the gradients; 0 in a lane that is left over.
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
    Chains chains(elements, blocks, inverse_mass, out.modulus);
    for (std::size_t row = 0; row < parts.size(); ++row) {
        if (parts[row] != ElementPart::guard) continue;
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + row;
        const BlockNodes nodes = elements.nodes_of(b);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real volume = volume_of(nodes, l);
            const bool acts = volume > 0 && chains.holds(nodes, l);
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
