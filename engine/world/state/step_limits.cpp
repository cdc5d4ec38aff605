#include "engine/world/state/step_limits.h"

#include <algorithm>
#include <tuple>

namespace skerry {

StepLimitReport& StepLimits::entry(StepLimit limit, BodyHandle body, const std::string& name) {
    const auto known = std::ranges::find_if(
        entries_, [&](const StepLimitReport& entry) { return entry.limit == limit && entry.body == body; });
    if (known != entries_.end()) return *known;
    return entries_.emplace_back(StepLimitReport{.limit = limit, .body = body, .body_name = name});
}

void StepLimits::count_step(StepLimit limit, BodyHandle body, const std::string& name, Real h) {
    StepLimitReport& of = entry(limit, body, name);
    ++of.steps;
    of.seconds += h;
}

void StepLimits::count_try(StepLimit limit, BodyHandle body, const std::string& name) {
    ++entry(limit, body, name).tries;
}

std::vector<StepLimitReport> StepLimits::report() const {
    std::vector<StepLimitReport> sorted = entries_;
    std::ranges::stable_sort(sorted, [](const StepLimitReport& a, const StepLimitReport& b) {
        return std::tuple(a.steps, a.tries) > std::tuple(b.steps, b.tries);
    });
    return sorted;
}

}  // namespace skerry
