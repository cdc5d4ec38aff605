// During steps, each rank keeps its own sums of energies, impulses and counts. The functions here add the sums of all
// ranks to the records of the run: before a check of the energy balance, and at the end of a call of advance.
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Sums of one rank since the last join.
struct JoinedSums {
    Real dissipated, plastic_work, work, energy_flow, momentum_flow;
    Vec3 impulse;
    std::uint64_t tested, hits, let_through;
};

/// Values in the report of one rank for one call of advance.
struct JoinedReport {
    Real held_penetration;
    HeldDepth held;
    Index crossed;
};

}  // namespace

void join_records(WorldState& world) {
    if (!world.ranks.on()) return;
    RankShare& share = world.ranks.share;
    RunCounters& counters = world.record.counters;
    Balance& balance = world.record.balance;
    CrossingTable& crossings = world.cache.crossings;
    const Balance own_balance = std::exchange(share.balance, {});
    balance.steps += own_balance.steps;
    const JoinedSums own_sums{std::exchange(share.dissipated, 0),
                              std::exchange(share.plastic_work, 0),
                              own_balance.work,
                              own_balance.energy_flow,
                              own_balance.momentum_flow,
                              own_balance.impulse,
                              crossings.tested - share.tested,
                              crossings.hits - share.hits,
                              crossings.let_through - share.let_through};
    crossings.tested = share.tested;
    crossings.hits = share.hits;
    crossings.let_through = share.let_through;
    for_each_gathered<JoinedSums>(*world.ranks.ranks, std::span(&own_sums, 1), [&](const JoinedSums& of_rank) {
        counters.dissipated += of_rank.dissipated;
        counters.plastic_work += of_rank.plastic_work;
        balance.work += of_rank.work;
        balance.energy_flow += of_rank.energy_flow;
        balance.momentum_flow += of_rank.momentum_flow;
        balance.impulse += of_rank.impulse;
        crossings.tested += of_rank.tested;
        crossings.hits += of_rank.hits;
        crossings.let_through += of_rank.let_through;
    });
    share.tested = crossings.tested;
    share.hits = crossings.hits;
    share.let_through = crossings.let_through;
}

void join_reports(WorldState& world, StepReport& report) {
    if (!world.ranks.on()) return;
    join_records(world);
    const JoinedReport own_report{report.held_penetration, world.record.held, report.crossed};
    report.crossed = 0;
    for_each_gathered<JoinedReport>(*world.ranks.ranks, std::span(&own_report, 1), [&](const JoinedReport& of_rank) {
        report.held_penetration = std::max(report.held_penetration, of_rank.held_penetration);
        report.crossed += of_rank.crossed;
        world.record.held.take(of_rank.held);
    });
}

}  // namespace skerry
