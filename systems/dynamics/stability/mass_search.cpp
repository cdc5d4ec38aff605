#include "systems/dynamics/stability/mass_search.h"

#include <algorithm>

#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/material/relaxation.h"

namespace skerry {

RestModuli::RestModuli(const ElementInputs& elements, Range blocks, Real longer) : elements_(elements) {
    Real fastest = 0;  // greatest frequency of an explicit element by itself [1/s]
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        if (elements.part[b] == ElementPart::guard) continue;
        const MaterialConstants material = elements.material_of(b);
        stiffest_ = std::max({stiffest_, 2 * material.shear_modulus, material.lame_lambda});
        if (elements.own_frequency.empty()) continue;
        const Real8 own = explicit_mask(b) * load(elements.own_frequency[b]);
        for (std::size_t l = 0; l < element_lanes; ++l) fastest = std::max<Real>(fastest, own[l]);
    }
    if (fastest > 0) relaxing_step_ = longer * step_times_frequency / fastest;
}

Real8 RestModuli::explicit_mask(std::size_t block) const {
    const Real8 one = Real8{} + 1.0;
    return elements_.implicit_modulus.empty() ? one
                                              : Real8(load(elements_.implicit_modulus[block]) > 0.0 ? Real8{} : one);
}

RestModuli::Moduli RestModuli::moduli(std::size_t block) const {
    // Lower limit on the shear modulus, as a fraction of the greatest modulus. It gives some mass even to elements
    // without stiffness.
    constexpr Real least = 1e-9;
    const MaterialConstants material = elements_.material_of(block);
    Moduli moduli{Real8{} + std::max(2 * material.shear_modulus, least * stiffest_),
                  Real8{} + std::max(material.lame_lambda, Real{0})};
    if (material.relaxes() && !elements_.relaxing_share.empty()) {
        const ViscousModuli viscous = viscous_moduli(material, elements_.relaxing_share[block]);
        const Real8 strain = springs_that_count(elements_.relaxation_rate[block], Real8{} + relaxing_step_);
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

void BandDecomposition::load_group(const BandMatrix& matrix, std::size_t group_index, Real limit) {
    const std::size_t first = group_index * matrix.group;
    rows_of_group_.assign(matrix.group * matrix.width, 0);
    matrix.add_rows(group_index, rows_of_group_.data(), matrix.width);
    for (std::size_t i = 0; i < matrix.group; ++i) {
        Real* const to = row(first + i);
        std::fill_n(to - (first + i) % row_step, stride_, Real{0});
        std::copy_n(&rows_of_group_[i * matrix.width], matrix.width, to);
        std::size_t used = matrix.width;
        while (used > 1 && to[used - 1] == 0) --used;
        to[0] = limit - to[0];
        for (std::size_t j = 1; j < used; ++j) to[j] = 0 - to[j];
        used_[(first + i) % rows_] = used;
    }
}

bool BandDecomposition::Pivots::reach(std::size_t r) const {
    for (std::size_t p = 0; p < pivots; ++p)
        if (factor(p, r) != 0) return true;
    return false;
}

void BandDecomposition::subtract_pivots(const Pivots& pivot, std::size_t r) {
    const std::size_t first = r - r % row_step, count = (pivot.end - first + row_step - 1) / row_step * row_step;
    const Real *const a = pivot.column(0, first), *const b = pivot.column(1, first), *const c = pivot.column(2, first),
                      *const d = pivot.column(3, first);
    const Real factor_a = pivot.factor(0, r), factor_b = pivot.factor(1, r), factor_c = pivot.factor(2, r),
               factor_d = pivot.factor(3, r);
    Real* const target = row(r) - r % row_step;
#pragma omp simd
    for (std::size_t j = 0; j < count; ++j)
        target[j] = (((target[j] - factor_a * a[j]) - factor_b * b[j]) - factor_c * c[j]) - factor_d * d[j];
}

void BandDecomposition::subtract_pivots_from_two(const Pivots& pivot, std::size_t r) {
    const std::size_t first = r - r % row_step, count = (pivot.end - first + row_step - 1) / row_step * row_step;
    const Real *const a = pivot.column(0, first), *const b = pivot.column(1, first), *const c = pivot.column(2, first),
                      *const d = pivot.column(3, first);
    const Real factor_a = pivot.factor(0, r), factor_b = pivot.factor(1, r), factor_c = pivot.factor(2, r),
               factor_d = pivot.factor(3, r);
    const Real next_a = pivot.factor(0, r + 1), next_b = pivot.factor(1, r + 1), next_c = pivot.factor(2, r + 1),
               next_d = pivot.factor(3, r + 1);
    Real *const target = row(r) - r % row_step, *const next_row = row(r + 1) - (r + 1) % row_step;
#pragma omp simd
    for (std::size_t j = 0; j < count; ++j) {
        target[j] = (((target[j] - factor_a * a[j]) - factor_b * b[j]) - factor_c * c[j]) - factor_d * d[j];
        next_row[j] = (((next_row[j] - next_a * a[j]) - next_b * b[j]) - next_c * c[j]) - next_d * d[j];
    }
}

bool BandDecomposition::is_below(const BandMatrix& matrix, Real limit) {
    const Real rounding = 1e-10 * limit;
    const std::size_t groups = matrix.size / matrix.group;
    // The window stores complete groups of rows, so that no group is split at its end. Each row has margins of unused
    // numbers, because registers are loaded from aligned addresses: a register length before the diagonal, and
    // `pivots - 1` numbers and a register length after the band.
    rows_ = ((matrix.width + 2 * pivots) / matrix.group + 2) * matrix.group;
    stride_ = (matrix.width + pivots + 3 * row_step) / row_step * row_step;
    window_.resize(rows_ * stride_);
    used_.resize(rows_);
    std::size_t loaded = 0;  // number of row groups loaded so far
    for (std::size_t k = 0; k < matrix.size; k += pivots) {
        const std::size_t count = std::min(pivots, matrix.size - k);
        while (loaded < groups && loaded * matrix.group < k + pivots + matrix.width)
            load_group(matrix, loaded++, limit);
        Pivots pivot{.first = k, .end = k + 1};
        for (std::size_t p = 0; p < count; ++p) {
            Real* const own = pivot.row[p] = row(k + p);
            // subtract multiples of the earlier pivot rows from this pivot row
            for (std::size_t before = 0; before < p; ++before) {
                const Real factor = pivot.factor(before, k + p);
                const Real* const earlier = pivot.column(before, k + p);
#pragma omp simd
                for (std::size_t j = 0; j < pivot.end - (k + p); ++j) own[j] -= factor * earlier[j];
            }
            if (!(own[0] > rounding)) return false;
            pivot.inverse[p] = 1 / own[0];
            pivot.end = std::min(std::max(pivot.end, k + p + used_[(k + p) % rows_]), matrix.size);
        }
        const auto use = [&](std::size_t r) { used_[r % rows_] = std::max(used_[r % rows_], pivot.end - r); };
        for (std::size_t r = k + count; r < pivot.end; ++r) {
            if (!pivot.reach(r)) continue;
            use(r);
            if (r % row_step == row_step - 1 || r + 1 == pivot.end || !pivot.reach(r + 1)) {
                subtract_pivots(pivot, r);
                continue;
            }
            use(r + 1);
            subtract_pivots_from_two(pivot, r++);
        }
    }
    return true;
}

}  // namespace skerry
