#include "systems/dynamics/checks/volume_ratios.h"

#include <cmath>

#include "systems/dynamics/elements/element_block.h"

namespace skerry {

namespace {

template <class Ratio>
VolumeRatios worst_of(std::span<const ElementLane> volume, Range blocks, Real near, Ratio&& ratio_of) {
    VolumeRatios worst{infinity, no_index};
    for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const Real8 ratio = ratio_of(b);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(volume[b][l] > 0)) continue;
            worst.near_inversion += ratio[l] < near;
            worst.inverted += ratio[l] < 0;
            // NaN counts as the smallest ratio. The first NaN is not replaced by later ratios.
            if (std::isnan(worst.smallest) || ratio[l] >= worst.smallest) continue;
            worst.smallest = ratio[l];
            worst.item = static_cast<Index>(b * element_lanes + l);
        }
    }
    return worst;
}

}  // namespace

VolumeRatios tetrahedron_volume_ratios(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                                       Range blocks, std::span<const Vec3> position) {
    return worst_of(volume, blocks, near_inversion, [&](std::size_t b) {
        const Real8 rest = load(volume[b]);
        return determinant(edges(node[b], position)) / (6.0 * (rest > 0.0 ? rest : Real8{} + 1.0));
    });
}

VolumeRatios element_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                   Real near) {
    return worst_of(elements.volume, blocks, near, [&](std::size_t b) {
        return elements.part[b] == ElementPart::guard
                   ? Real8{} + 1.0
                   : determinant(deformation_gradient(elements.nodes_of(b), position));
    });
}

}  // namespace skerry
