#include "systems/solver/schedule_regions.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "jobs/parallel_for.h"
#include "jobs/reduce.h"
#include "systems/solver/regions/lane_queue.h"

namespace skerry {
namespace {

// Constants of the cost model of docs/methods/regions.md 4.1 [microseconds], measured on chains of 2 to 12 contacts and
// sheets of 18 to 1922, on one core of a shared machine (AVX-512). Their ratios decide the order of regions, their
// absolute values only the size of tasks.
constexpr Real single_cost = 0.06;
constexpr Real region_cost = 0.1, contact_cost = 0.06;  // per region, per contact: loading, warm start, writing back
constexpr Real contact_sweep_cost = 0.03, lane_contact_sweep_cost = 0.008;
// Limits of the predicted cost of a task [microseconds]. The lower limit is several times the cost of starting a task,
// which is about 1 microsecond.
constexpr Real largest_task = 50, smallest_task = 4;
// Number of tasks per worker. A task then takes a quarter of the mean time per worker, and the worker that finishes
// last is late by at most about this time.
constexpr Real tasks_per_worker = 4;

constexpr Real no_history = -1;
constexpr Real forgetting = 0.3;  // weight of the last step in the moving average of the number of sweeps
constexpr Real caution = 1.2;     // ratio of the predicted number of sweeps to the moving average
constexpr Real fewest_sweeps = 4;
// Predicted number of sweeps of a new region: first_sweeps + sweeps_of_size times the square root of the number of
// contacts.
constexpr Real first_sweeps = 8, sweeps_of_size = 2;

constexpr std::size_t regions_per_block = 256;  // chosen so that a block takes a few microseconds

/// Number of contacts plus joint blocks plus cables of a region.
Index contact_count(const RegionTable& regions, Index region) {
    const auto r = static_cast<std::size_t>(region);
    return regions.contacts.offset[region + 1] - regions.contacts.offset[region] +
           static_cast<Index>(regions.joints_of(r).size() + regions.cables_of(r).size());
}

/// Identifier of a region without contacts: its second word contains the index of the region's first joint block, or of
/// its first cable if it has no joints. Its first word exceeds that of every contact key, because identifiers must
/// ascend and these regions come last in the list.
ContactKey id_without_contacts(const RegionTable& regions, std::size_t region) {
    constexpr std::uint64_t last = ~std::uint64_t{0}, of_cable = std::uint64_t{1} << 32;
    const std::span<const Index> joints = regions.joints_of(region);
    return {last, joints.empty() ? of_cable + static_cast<std::uint64_t>(regions.cables[region][0])
                                 : static_cast<std::uint64_t>(joints[0])};
}

bool fits_lanes(Index contacts) {
    return contacts > 1 && contacts <= largest_lane_region;
}

Real predicted_sweeps(Index contacts, Real average, const SolverSettings& settings) {
    if (settings.fixed_iterations) return settings.max_iterations;
    if (average != no_history) return std::max(fewest_sweeps, caution * average);
    return first_sweeps + sweeps_of_size * std::sqrt(static_cast<Real>(contacts));
}

Real predicted_cost(Index contacts, Real average, bool lanes, const SolverSettings& settings) {
    if (contacts == 1 && !settings.fixed_iterations) return single_cost;
    const Real sweep = lanes && fits_lanes(contacts) ? lane_contact_sweep_cost : contact_sweep_cost;
    return region_cost +
           static_cast<Real>(contacts) * (contact_cost + sweep * predicted_sweeps(contacts, average, settings));
}

/// Sorts the regions: those too large for lanes by descending cost, then the small ones by descending size. The
/// counting sort places small regions of equal size next to each other, so that lanes can solve them together.
void sort_regions(std::span<const Index> contacts, const Column<Real>& cost, RegionTable& regions) {
    const Index count = static_cast<Index>(regions.size());
    // For each size class, from large to small: index in regions.order at which the next region of the class is
    // written. Class 0: too large for lanes.
    std::array<Index, largest_lane_region + 2> begin{};
    const auto group = [&](Index r) { return std::max<Index>(0, largest_lane_region + 1 - contacts[r]); };
    for (Index r = 0; r < count; ++r) ++begin[static_cast<std::size_t>(group(r)) + 1];
    const Index large = begin[1];
    for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
    for (Index r = 0; r < count; ++r) regions.order[begin[static_cast<std::size_t>(group(r))]++] = r;
    std::sort(regions.order.begin(), regions.order.begin() + large,
              [&](Index a, Index b) { return cost[a] != cost[b] ? cost[a] > cost[b] : a < b; });
}

}  // namespace

void recall_regions(Executor& executor, std::span<const ContactKey> key, RegionMemory& memory, RegionTable& regions) {
    const std::size_t count = regions.size();
    regions.id.resize(key.empty() ? 0 : count);
    RegionHistoryTable& present = memory.present;
    const RegionHistoryTable& history = memory.history;
    present.resize(count);
    parallel_for(executor, count, regions_per_block, [&](std::size_t begin, std::size_t end) {
        // Each block finds its first region among the regions of the previous step by binary search. Then it reads the
        // list of the previous step and the present list side by side, as in a merge.
        std::size_t old = 0;
        for (std::size_t r = begin; r < end; ++r) {
            const Index contacts = contact_count(regions, static_cast<Index>(r));
            present.contacts[r] = contacts;
            present.sweeps[r] = no_history;
            present.age[r] = 0;
            if (key.empty()) continue;
            // Contacts ascend by key and regions by their first contact. So the identifiers ascend in the list of this
            // step and in that of the previous step.
            const ContactKey id =
                regions.contacts[r].empty() ? id_without_contacts(regions, r) : key[regions.contacts[r][0]];
            regions.id[r] = present.id[r] = id;
            if (r == begin)
                old = static_cast<std::size_t>(std::ranges::lower_bound(history.id, id) - history.id.begin());
            while (old < history.size() && history.id[old] < id) ++old;
            if (old == history.size() || history.id[old] != id) continue;
            present.sweeps[r] = history.sweeps[old];
            if (history.contacts[old] == contacts) present.age[r] = history.age[old] + 1;
        }
    });
}

void schedule_regions(Executor& executor, const SolverSettings& settings, RegionMemory& memory, RegionTable& regions) {
    const Index count = static_cast<Index>(regions.size());
    const bool lanes = lanes_allowed(settings);
    make_room(memory.cost, regions.size());
    const Real total = reduce(
        executor, regions.size(), regions_per_block, memory.cost_parts, Real(0),
        [&](std::size_t begin, std::size_t end) {
            Real sum = 0;
            for (std::size_t r = begin; r < end; ++r) {
                memory.cost[r] = predicted_cost(memory.present.contacts[r], memory.present.sweeps[r], lanes, settings);
                sum += memory.cost[r];
            }
            return sum;
        },
        std::plus<>());
    sort_regions(memory.present.contacts, memory.cost, regions);
    const int workers = executor.worker_count();
    const Real share = total / (tasks_per_worker * workers);
    const Real task_cost = workers == 1 ? total : std::clamp(share, smallest_task, largest_task);
    // Each pass of the loop writes the task that is being filled. `tasks` advances only if this task is full. So the
    // loop has no branch that the processor could mispredict.
    memory.task.resize(regions.size());
    std::size_t tasks = 0;
    Index begin = 0;
    Real cost = 0;
    for (Index k = 0; k < count; ++k) {
        cost += memory.cost[regions.order[k]];
        const bool full = !(cost < task_cost) || k + 1 == count;
        memory.task[tasks] = {begin, k + 1};
        tasks += full;
        begin = full ? k + 1 : begin;
        cost = full ? 0 : cost;
    }
    memory.task.resize(tasks);
}

void remember_regions(RegionMemory& memory, const RegionTable& regions) {
    RegionHistoryTable& present = memory.present;
    if (regions.id.empty()) present.resize(0);
    for (std::size_t r = 0; r < present.size(); ++r) {
        const Real now = regions.iterations[r];
        present.sweeps[r] =
            present.sweeps[r] == no_history ? now : (1 - forgetting) * present.sweeps[r] + forgetting * now;
    }
    std::swap(memory.history, present);
}

}  // namespace skerry
