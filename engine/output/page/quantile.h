// Estimates quantiles of many positive numbers without storing the numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>

#include "components/types.h"

namespace skerry {

/// Histogram of positive values, whose quantiles serve as upper ends of legends. A quantile that excludes the few
/// largest values keeps a single extreme value from stretching the legend. Each bin is 2 % wide, relative to its lower
/// end.
class Quantile {
public:
    void add(Real value) {
        // values up to zero are ignored, because a legend starts at zero
        if (!(value > 0) || !std::isfinite(value)) return;
        ++bins_[static_cast<int>(std::floor(std::log(value) / log_width))];
        ++count_;
        if (value > max_) max_ = value;
    }
    /// Returns the value below which this fraction of the positive values lies, accurate to 2 %. Returns 0 if
    /// there are no values.
    Real at(Real fraction) const {
        std::uint64_t below = 0;
        for (const auto& [bin, count] : bins_) {
            below += count;
            if (static_cast<Real>(below) >= fraction * static_cast<Real>(count_))
                return std::fmin(std::exp((bin + 1) * log_width), max_);
        }
        return max_;
    }
    Real max() const { return max_; }

private:
    static constexpr Real log_width = 0.02;

    std::map<int, std::uint64_t> bins_;
    std::uint64_t count_ = 0;
    Real max_ = 0;
};

}  // namespace skerry
