// Counts how often each cause limited the length of a step in a run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "skerry/report.h"

namespace skerry {

/// Counts steps and discarded attempts for each pair of a cause and a body. Memory is allocated only when a pair occurs
/// for the first time.
class StepLimits {
public:
    /// Counts a committed step of length `h` [s] that the given cause has limited.
    void count_step(StepLimit limit, BodyHandle body, const std::string& name, Real h);
    /// Counts an attempt at a step that was discarded for the given cause.
    void count_try(StepLimit limit, BodyHandle body, const std::string& name);
    /// Returns all entries, in descending order of their numbers of steps.
    std::vector<StepLimitReport> report() const;
    /// Returns all entries in the order of their first occurrence.
    const std::vector<StepLimitReport>& entries() const { return entries_; }
    void restore(std::vector<StepLimitReport> entries) { entries_ = std::move(entries); }

private:
    StepLimitReport& entry(StepLimit limit, BodyHandle body, const std::string& name);

    std::vector<StepLimitReport> entries_;
};

}  // namespace skerry
