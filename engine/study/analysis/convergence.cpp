#include "engine/study/analysis/convergence.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

constexpr Real unknown = std::numeric_limits<Real>::quiet_NaN();
// Factor by which error bounds exceed estimated errors (grid convergence index, Roache 1994). For two levels with the
// ratio 2 and the assumed order 1, the bound of the coarser level is three times their difference.
constexpr Real safety = 1.5;
constexpr Real assumed_order = 1;  // order that is assumed if there are only two levels
// An observed order agrees with the theory if it is between `near_least` times the lowest and `near_most` times the
// highest order of the theory.
constexpr Real near_least = 0.5, near_most = 1.5;
// Two levels that differ by more than this share of the size of the value are too coarse to converge with any order.
constexpr Real coarse_share = 0.3;

}  // namespace

Convergence::Convergence(std::vector<ConvergenceLevel> levels, TheoryOrder theory, Real noise, Real size)
    : levels_(std::move(levels)) {
    std::erase_if(levels_, [](const ConvergenceLevel& level) { return !std::isfinite(level.value); });
    std::ranges::sort(levels_, std::ranges::greater(), &ConvergenceLevel::h);
    const bool has_scene = std::ranges::any_of(levels_, [](const ConvergenceLevel& level) { return level.h == 1; });
    if (has_scene && levels_.size() > 1) find_order(theory, noise, size);
}

void Convergence::find_order(TheoryOrder theory, Real noise, Real size) {
    const std::size_t n = levels_.size();
    const ConvergenceLevel &fine = levels_[n - 1], &middle = levels_[n - 2];
    const Real ratio = middle.h / fine.h, difference = middle.value - fine.value;
    const auto remainder = [&](Real order) { return std::abs(difference) / (std::pow(ratio, order) - 1); };
    used_order_ = assumed_order;
    remainder_ = remainder(used_order_);
    if (std::abs(difference) <= noise) {
        shape_ = ConvergenceShape::equal;
        return;
    }
    const auto be_coarse = [&] {
        shape_ = ConvergenceShape::coarse;
        used_order_ = 0;
        // The error may be as large as the value itself. A position can contain a large constant part without error, so
        // its error is at most `size` (the size of its change) plus the difference of the levels.
        least_error_ = std::min(size + std::abs(difference), std::max(std::abs(middle.value), std::abs(fine.value)));
    };
    const bool differs_much = std::abs(difference) > coarse_share * size;
    constexpr Real same_ratio = 1e-6;
    if (n == 2 || std::abs(levels_[n - 3].h / middle.h - ratio) > same_ratio * ratio) {
        shape_ = ConvergenceShape::two_levels;
        if (differs_much) be_coarse();
        return;
    }
    const Real coarse_difference = levels_[n - 3].value - middle.value;
    order_ = std::log(std::abs(coarse_difference / difference)) / std::log(ratio);
    const bool fast = order_ > near_most * theory.most;
    if (coarse_difference * difference < 0 && !fast) {
        shape_ = ConvergenceShape::oscillating;
        used_order_ = 0;
        // Successive differences have opposite signs if two terms of the error do, such as a h^2 and b h^3 with a b <
        // 0. `remainder_` keeps the estimate with order 1, because it is above such an error.
    } else if (order_ < near_least * theory.least) {
        // An order near 0 predicts an unbounded error, so the estimate is limited to the sum of both differences.
        shape_ = ConvergenceShape::slow;
        used_order_ = 0;
        remainder_ = std::abs(coarse_difference + difference);
        if (order_ > 0) remainder_ = std::min(remainder_, remainder(order_));
        if (order_ > 0 || !differs_much) return;
        // Meshes that lock (are far too stiff), such as a single layer of linear elements, change the value more from
        // level to level until they are fine enough. The assumption is that the difference grows once more, by at most
        // the ratio of the last two differences, and then falls with order `theory.least`.
        be_coarse();
        const Real growth = std::min(std::abs(difference / coarse_difference), std::pow(ratio, theory.most));
        remainder_ = std::max(remainder_, growth * (std::abs(difference) + remainder(theory.least)));
    } else {
        shape_ = fast ? ConvergenceShape::fast : ConvergenceShape::regular;
        used_order_ = std::min(order_, theory.most);
        // The fine levels may agree by accident. The error is therefore at least half of the error that the difference
        // of the coarse levels predicts with the highest order of the theory.
        const Real power = std::pow(ratio, theory.most);
        remainder_ = std::max(remainder(used_order_), std::abs(coarse_difference) / (2 * power * (power - 1)));
    }
}

bool Convergence::irregular() const {
    return shape_ == ConvergenceShape::coarse || shape_ == ConvergenceShape::slow || shape_ == ConvergenceShape::fast ||
           shape_ == ConvergenceShape::oscillating;
}

Real Convergence::error_of(Real value) const {
    if (shape_ == ConvergenceShape::unmeasured) return unknown;
    return std::max(least_error_, safety * (std::abs(value - levels_.back().value) + remainder_));
}

Real Convergence::error_at(Real h) const {
    if (shape_ == ConvergenceShape::unmeasured) return unknown;
    const Real finest = levels_.back().h;
    if (h < finest) return std::max(least_error_, safety * remainder_ * std::pow(h / finest, used_order_));
    // The value of a coarse level can be near the limit by accident. Its error counts as at least that of each finer
    // level.
    Real error = 0;
    for (const ConvergenceLevel& level : levels_)
        if (level.h <= h) error = std::max(error, error_of(level.value));
    const bool is_level = std::ranges::any_of(levels_, [h](const ConvergenceLevel& level) { return level.h == h; });
    return is_level ? error : unknown;
}

Real Convergence::limit() const {
    if (shape_ == ConvergenceShape::unmeasured || irregular()) return unknown;
    const ConvergenceLevel& fine = levels_.back();
    if (shape_ != ConvergenceShape::regular) return fine.value;
    return fine.value + std::copysign(remainder_, fine.value - levels_[levels_.size() - 2].value);
}

Real Convergence::limit_error() const {
    return shape_ == ConvergenceShape::unmeasured || irregular() ? unknown : safety * remainder_;
}

}  // namespace skerry
