#include "systems/dynamics/clusters/implicit_elements.h"

#include <algorithm>
#include <cmath>

#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real of_implicit,
                 std::span<ElementLane> leeway) {
    std::ranges::fill(leeway, ElementLane{{1, 1, 1, 1, 1, 1, 1, 1}});
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        if (!(modulus[e / element_lanes][e % element_lanes] > 0)) continue;
        for (const Index t : tetrahedra[e]) {
            const auto at = static_cast<std::size_t>(t);
            leeway[at / element_lanes][at % element_lanes] = of_implicit;
        }
    }
}

void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time) {
    constexpr Real of_step = 0.1;  // omega h stays below sqrt(4 - 2 * 1.8^2 * 0.1), which is more than 1.8
    for (std::size_t b = 0; b < modulus.size(); ++b)
        viscous_time[b] = std::ranges::any_of(modulus[b].lane, [](Real of) { return of > 0; }) ? of_step * step : 0;
}

Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus) {
    Real worst = 0;
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& taken = modulus[b - static_cast<std::size_t>(blocks.begin)];
        if (std::none_of(taken.lane, taken.lane + element_lanes, [](Real m) { return m > 0; })) continue;
        const Real8 stiffness = stiffness_of(elements, b, deformation_of(elements, b, position), q);
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (taken[l] > 0) worst = std::max(worst, stiffness[l] / taken[l]);
    }
    return worst;
}

Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity) {
    Real energy = 0;
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& taken = modulus[b - static_cast<std::size_t>(blocks.begin)];
        const LaneMat3<Real8> rate = deformation_gradient(elements.nodes_of(b), velocity);
        const Real8 square = inner_product(rate, rate);
        for (std::size_t l = 0; l < element_lanes; ++l) energy += taken[l] * elements.volume[b][l] * square[l];
    }
    return inertia_of_stiffness(step) * energy / 2;
}

}  // namespace skerry
