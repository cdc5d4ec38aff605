#include "systems/solver/schedule_regions.h"

#include <algorithm>
#include <cmath>

namespace skerry {
namespace {

// microseconds, measured on one 2.5 GHz core; only their ratios matter
constexpr Real region_cost = 0.3, single_cost = 0.06, contact_sweep_cost = 0.025;
constexpr Real task_cost = 30;  // starting a task costs about 1

Index contact_count(const RegionTable& regions, Index region) {
    return regions.contacts.offset[region + 1] - regions.contacts.offset[region];
}

Real predicted_cost(Index contacts, const SolverSettings& settings) {
    if (contacts == 1 && !settings.fixed_iterations) return single_cost;
    const Real sweeps = settings.fixed_iterations ? settings.max_iterations : 8 + 2 * std::sqrt(static_cast<Real>(contacts));
    return region_cost + contact_sweep_cost * static_cast<Real>(contacts) * sweeps;
}

/// The cost grows with the contacts: sorting by their number is enough, and the many regions of one contact need no sorting.
void sort_regions(RegionTable& regions) {
    const Index count = static_cast<Index>(regions.size());
    Index several = 0;
    for (Index r = 0; r < count; ++r)
        if (contact_count(regions, r) > 1) regions.order[several++] = r;
    std::sort(regions.order.begin(), regions.order.begin() + several, [&](Index a, Index b) {
        const Index count_a = contact_count(regions, a), count_b = contact_count(regions, b);
        return count_a != count_b ? count_a > count_b : a < b;
    });
    for (Index r = 0; r < count; ++r)
        if (contact_count(regions, r) == 1) regions.order[several++] = r;
}

}  // namespace

void schedule_regions(const SolverSettings& settings, RegionTable& regions, Column<RegionTask>& task) {
    sort_regions(regions);
    task.clear();
    const Index count = static_cast<Index>(regions.size());
    Index begin = 0;
    Real cost = 0;
    for (Index k = 0; k < count; ++k) {
        cost += predicted_cost(contact_count(regions, regions.order[k]), settings);
        if (cost < task_cost && k + 1 < count) continue;
        task.push_back({begin, k + 1});
        begin = k + 1;
        cost = 0;
    }
}

}  // namespace skerry
