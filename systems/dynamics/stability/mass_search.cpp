#include "systems/dynamics/stability/mass_search.h"

#include <algorithm>
#include <array>

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

void BandDecomposition::load_group(const BandMatrix& matrix, std::size_t of_group, Real limit) {
    const std::size_t first = of_group * matrix.group;
    for (std::size_t i = 0; i < matrix.group; ++i) std::fill_n(row(first + i), stride_, Real{0});
    matrix.add_rows(of_group, row(first), stride_);
    for (std::size_t i = 0; i < matrix.group; ++i) {
        Real* const to = row(first + i);
        std::size_t used = matrix.width;
        while (used > 1 && to[used - 1] == 0) --used;
        to[0] = limit - to[0];
        for (std::size_t j = 1; j < used; ++j) to[j] = 0 - to[j];
        used_[(first + i) % rows_] = used;
    }
}

bool BandDecomposition::is_below(const BandMatrix& matrix, Real limit) {
    constexpr std::size_t pivots = 4;  // at once: what they take from a row is loaded and stored once
    const Real rounding = 1e-10 * limit;
    const std::size_t groups = matrix.size / matrix.group;
    // Whole groups: none is torn where the window ends. A row reaches `pivots - 1` beyond itself, where there are
    // zeros.
    rows_ = ((matrix.width + 2 * pivots) / matrix.group + 2) * matrix.group;
    stride_ = (matrix.width + pivots + 7) / 8 * 8;
    window_.resize(rows_ * stride_);
    used_.resize(rows_);
    std::size_t loaded = 0;  // groups
    for (std::size_t k = 0; k < matrix.size; k += pivots) {
        const std::size_t count = std::min(pivots, matrix.size - k);
        while (loaded < groups && loaded * matrix.group < k + pivots + matrix.width)
            load_group(matrix, loaded++, limit);
        std::array<Real*, pivots> pivot{};
        std::array<Real, pivots> inverse{};
        std::size_t end = k + 1;  // of what the pivots reach
        for (std::size_t p = 0; p < count; ++p) {
            pivot[p] = row(k + p);
            // what the pivots before it take from it
            for (std::size_t before = 0; before < p; ++before) {
                const Real factor = pivot[before][p - before] * inverse[before];
                for (std::size_t j = k + p; j < end; ++j)
                    pivot[p][j - (k + p)] -= factor * pivot[before][j - (k + before)];
            }
            if (!(pivot[p][0] > rounding)) return false;
            inverse[p] = 1 / pivot[p][0];
            end = std::min(std::max(end, k + p + used_[(k + p) % rows_]), matrix.size);
        }
        for (std::size_t r = k + count; r < end; ++r) {
            const std::size_t at = r - k;
            const Real *const a = pivot[0] + at, *const b = pivot[1] + (at - 1), *const c = pivot[2] + (at - 2),
                              *const d = pivot[3] + (at - 3);
            const Real of_a = a[0] * inverse[0], of_b = b[0] * inverse[1], of_c = c[0] * inverse[2],
                       of_d = d[0] * inverse[3];
            if (of_a == 0 && of_b == 0 && of_c == 0 && of_d == 0) continue;
            Real* const to = row(r);
#pragma omp simd
            for (std::size_t j = 0; j < end - r; ++j)
                to[j] = (((to[j] - of_a * a[j]) - of_b * b[j]) - of_c * c[j]) - of_d * d[j];
            std::size_t& used = used_[r % rows_];
            used = std::max(used, end - r);
        }
    }
    return true;
}

}  // namespace skerry
