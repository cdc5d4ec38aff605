#include "systems/dynamics/stability/mass_search.h"

#include <algorithm>

#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/material/relaxation.h"

namespace skerry {

RestModuli::RestModuli(const ElementInputs& elements, Range blocks, Real longer) : elements_(elements) {
    Real fastest = 0;  // 1/s
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        if (elements.part[b] == ElementPart::guard) continue;
        const MaterialConstants material = elements.material_of(b);
        stiffest_ = std::max({stiffest_, 2 * material.shear_modulus, material.lame_lambda});
        if (elements.own_frequency.empty()) continue;
        const Real8 own = of_explicit(b) * load(elements.own_frequency[b]);
        for (std::size_t l = 0; l < element_lanes; ++l) fastest = std::max<Real>(fastest, own[l]);
    }
    if (fastest > 0) relaxing_step_ = longer * step_times_frequency / fastest;
}

Real8 RestModuli::of_explicit(std::size_t block) const {
    const Real8 one = Real8{} + 1.0;
    return elements_.implicit_modulus.empty() ? one
                                              : Real8(load(elements_.implicit_modulus[block]) > 0.0 ? Real8{} : one);
}

RestModuli::Moduli RestModuli::of(std::size_t block) const {
    constexpr Real least = 1e-9;  // of the stiffest: what has no stiffness takes some mass all the same
    const MaterialConstants material = elements_.material_of(block);
    Moduli moduli{Real8{} + std::max(2 * material.shear_modulus, least * stiffest_),
                  Real8{} + std::max(material.lame_lambda, Real{0})};
    if (material.relaxes() && !elements_.relaxing_share.empty()) {
        const ViscousModuli viscous = viscous_moduli(material, elements_.relaxing_share[block]);
        const Real8 strain = 2.0 / (2.0 + relaxing_step_ * load(elements_.relaxation_rate[block]));
        const Real8 volume = 2.0 / (2.0 + (relaxing_step_ / bulk_time) * load(elements_.own_frequency[block]));
        moduli.shear += 2 * viscous.mu * strain;
        moduli.volumetric += std::max(viscous.lambda, Real{0}) * strain + viscous.bulk * volume;
    }
    return moduli;
}

void sort_along(std::span<const Vec3> position, std::span<Index> nodes) {
    Vec3 low = position[static_cast<std::size_t>(nodes[0])], high = low;
    for (const Index n : nodes) {
        low = low.cwiseMin(position[static_cast<std::size_t>(n)]);
        high = high.cwiseMax(position[static_cast<std::size_t>(n)]);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    std::ranges::sort(nodes, [&](Index a, Index b) {
        const Real x = position[static_cast<std::size_t>(a)][axis], y = position[static_cast<std::size_t>(b)][axis];
        return x != y ? x < y : a < b;
    });
}

bool is_band_below(std::span<const Real> matrix, std::size_t width, Real limit, std::vector<Real>& rest) {
    const Real rounding = 1e-10 * limit;
    const std::size_t size = matrix.size() / width;
    rest.resize(matrix.size());
    for (std::size_t k = 0; k < size; ++k) {
        Real* const row = &rest[k * width];
        const Real* const of_matrix = &matrix[k * width];
        row[0] = limit - of_matrix[0];
        for (std::size_t j = 1; j < width; ++j) row[j] = 0 - of_matrix[j];
    }
    for (std::size_t k = 0; k < size; ++k) {
        const Real* const row = &rest[k * width];
        if (!(row[0] > rounding)) return false;
        const Real inverse = 1 / row[0];
        const std::size_t end = std::min(width, size - k);
        for (std::size_t i = 1; i < end; ++i) {
            const Real factor = row[i] * inverse;
            if (factor == 0) continue;
            Real* const to = &rest[(k + i) * width];
            const Real* const from = row + i;
#pragma omp simd
            for (std::size_t j = 0; j < end - i; ++j) to[j] -= factor * from[j];
        }
    }
    return true;
}

}  // namespace skerry
