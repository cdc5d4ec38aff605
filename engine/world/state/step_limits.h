// Causes that kept the steps of a run from being longer.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "skerry/report.h"

namespace skerry {

/// Counts by cause and body. A known pair of the two costs no allocation.
class StepLimits {
public:
    /// Counts a committed step of `h` seconds.
    void count_step(StepLimit limit, BodyHandle body, const std::string& name, Real h);
    /// Counts a try that was given up.
    void count_try(StepLimit limit, BodyHandle body, const std::string& name);
    /// Entries sorted by steps, most first.
    std::vector<StepLimitReport> report() const;
    /// Entries in the order in which they were first seen.
    const std::vector<StepLimitReport>& entries() const { return entries_; }
    void restore(std::vector<StepLimitReport> entries) { entries_ = std::move(entries); }

private:
    StepLimitReport& entry(StepLimit limit, BodyHandle body, const std::string& name);

    std::vector<StepLimitReport> entries_;
};

}  // namespace skerry
