#include "systems/solver/local/cable_law.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// Sum of mobility entries of both signs. They cancel, for example, where a cable runs straight through a moving point.
struct MobilitySum {
    Real sum = 0, size = 0;  // sum of the entries, and of their absolute values [1/kg]

    void add(Real entry) {
        sum += entry;
        size += std::abs(entry);
    }
    /// The sum, or 0 if it is only a rounding error.
    Real value() const {
        constexpr Real rounding = 1e-12;
        return sum > rounding * size ? sum : 0;
    }
};

}  // namespace

Vec3 CableLaw::at_point(std::span<const Real> impulses, std::size_t p) const {
    if (is_tie) return {impulses[0], impulses[1], impulses[2]};
    Vec3 sum = Vec3::Zero();
    if (p < segments()) sum += impulses[p] * direction[p];
    if (p > 0) sum -= impulses[p - 1] * direction[p - 1];
    return sum;
}

void CableLaw::read(std::span<const Vec4> point, std::span<Real> impulse_of_segment) const {
    if (is_tie) {
        for (std::size_t k = 0; k < 3; ++k) impulse_of_segment[k] = point[0][static_cast<Index>(k)];
        return;
    }
    Vec3 last = Vec3::Zero();
    std::size_t known = 0;  // number of segments whose impulse is known
    for (std::size_t s = 0; s < segments(); ++s) {
        const bool has_length = !direction[s].isZero(0);
        if (!has_length && known == 0) continue;
        impulse_of_segment[s] = has_length ? direction[s].dot(point[s].head<3>() + last) : impulse_of_segment[s - 1];
        last = impulse_of_segment[s] * direction[s];
        while (known < s) impulse_of_segment[known++] = impulse_of_segment[s];
        known = s + 1;
    }
    std::ranges::fill(impulse_of_segment.subspan(known, segments() - known), Real(0));
}

void CableLaw::prepare() const {
    MobilitySum mobility_sum;
    for (std::size_t s = segments(); s-- > 0;) {
        mobility_sum.add(entry(s, s));
        for (std::size_t m = s + 1; m < segments(); ++m) {
            mobility_sum.add(entry(s, m));
            mobility_sum.add(entry(m, s));
        }
        far_mobility[s] = mobility_sum.value();
    }
}

Real CableLaw::far_rate(std::size_t s) const {
    Real sum = 0;
    for (std::size_t m = s; m < segments(); ++m) sum += rate[m];
    return sum;
}

Real CableLaw::next_impulse(std::size_t s, Real rate_mobility) const {
    if (s == 0 && !by_length) return prescribed;
    const Real excess = far_rate(s) - (s == 0 ? prescribed : Real(0));
    const Real next = rate_mobility > 0 ? impulse[s] + excess / rate_mobility : impulse[s];
    if (s == 0) return std::max(Real(0), next);
    return std::clamp(next, impulse[s - 1] / most_ratio[s], impulse[s - 1] * most_ratio[s]);
}

/// Applies the law to segment `s`. The impulses of later segments keep their ratios to the impulse of `s`. Returns the
/// absolute change of this impulse [N s].
Real CableLaw::step(std::size_t s) const {
    const std::size_t count = segments();
    const Real present = impulse[s];
    const auto ratio = [&](std::size_t m) { return present > 0 ? impulse[m] / present : Real(1); };
    MobilitySum rate_mobility;  // decrease of far_rate(s) per unit change of impulse[s] [1/kg]
    for (std::size_t m = s; m < count; ++m)
        for (std::size_t row = s; row < count; ++row) rate_mobility.add(entry(row, m) * ratio(m));
    const Real next = next_impulse(s, rate_mobility.value());
    const Real change = next - present;
    if (change == 0) return 0;
    for (std::size_t m = count; m-- > s;) {
        const Real part = ratio(m) * change;
        for (std::size_t row = 0; row < count; ++row) rate[row] -= entry(row, m) * part;
        impulse[m] += part;
    }
    impulse[s] = next;
    return std::abs(change);
}

Vec3 CableLaw::change_of_tie() const {
    const Eigen::Map<const Mat3> matrix(mobility.data());
    return -matrix.ldlt().solve(Eigen::Map<const Vec3>(rate.data()));
}

void CableLaw::solve() const {
    if (is_tie) {
        Eigen::Map<Vec3>(impulse.data()) += change_of_tie();
        std::ranges::fill(rate, Real(0));
        return;
    }
    // If the passes end before convergence, the next sweep of the region continues from their impulses. So max_passes
    // does not limit the accuracy.
    constexpr int max_passes = 50;
    constexpr Real rounding = 1e-15;
    for (int pass = 0; pass < max_passes; ++pass) {
        Real change = 0;
        for (std::size_t s = 0; s < segments(); ++s) change = std::max(change, step(s));
        if (change <= rounding * *std::ranges::max_element(impulse)) return;
    }
}

Real CableLaw::squared_residual() const {
    if (is_tie) return -change_of_tie().dot(Eigen::Map<const Vec3>(rate.data()));
    Real sum = 0;
    for (std::size_t s = 0; s < segments(); ++s) {
        const Real difference = impulse[s] - next_impulse(s, far_mobility[s]);
        sum += far_mobility[s] * difference * difference;
    }
    return sum;
}

Real CableLaw::product(std::span<const Real> a, std::span<const Real> b) const {
    Real sum = 0;
    for (std::size_t row = 0; row < segments(); ++row)
        for (std::size_t column = 0; column < segments(); ++column) sum += a[row] * entry(row, column) * b[column];
    return sum;
}

}  // namespace skerry
