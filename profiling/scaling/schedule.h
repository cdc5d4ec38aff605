// What a recording takes on a number of cores: list scheduling of its pieces, with stated costs of the machine.
#pragma once

#include "profiling/scaling/recording.h"

namespace skerry::profiling {

/// A machine. What two virtual cores with one cache cost was measured on such (measure_costs.h, docs/scaling.md); what
/// goes beyond one chiplet was not measured at all.
struct MachineModel {
    // s, from handing out blocks to the first of them on a worker that looks for work: measured with oneTBB, 1.5 to 2.5
    double join = 2e-6;
    // s, the same of a worker that sleeps and is woken by the system: measured, 18 to 37; half as long without a
    // hypervisor
    double wake_up = 20e-6;
    // s, a worker without work looks for some this long before it sleeps: measured, between 100 and 200
    double patience = 150e-6;
    // s, what a phase of a Team costs (jobs/team.h)
    double barrier = 0.3e-6;
    // s, for a cache line to go from core to core, and so for a block that is taken from a counter from which another
    // took the one before: 20 ns within a chiplet, about 100 between them (published measurements of such processors)
    double line_transfer = 20e-9, far_line_transfer = 100e-9;

    int cores_per_chiplet = 8;
    double cache_per_chiplet = 32e6;  // bytes, of the last level
    double bandwidth = 370e9;         // bytes/s, of all memory of a socket of 64 cores (twelve channels, sustained)
    // bytes/s that a core gets of what another core of its chiplet has written last: set by the stages of one scene
    // (scenes/table.json) on two threads; of what another chiplet has: half of it, a guess
    double near_rate = 30e9, far_rate = 15e9;
    // Part of what a block of a core's own share reads that another has written: a guess. Rows stand in the order of
    // bodies in all tables, so shares of different loops are about the same bodies; pairs reach over to neighbours.
    double own_from_elsewhere = 0.25;

    /// Nothing costs anything: what the work alone allows.
    static MachineModel free_of_cost();
};

/// What moves while the steps run, for the share of the bandwidth.
struct Traffic {
    double bytes_per_second = 0;  // of one core alone
    double working_set = 0;       // bytes that each step reads
};

/// Seconds that the recording takes on `cores` cores. A worker takes stages that are ready, then blocks of what is
/// handed out, first those of its own share, then of the next ones, and stays with a loop until it has no more; who
/// handed it out waits for its last block. A Team has who is free when its first phase begins, up to
/// Team::most_members.
double predict_seconds(const Recording& recording, int cores, const MachineModel& machine, const Traffic& traffic = {});

/// Where a stage's share of the time goes, s: of each the time of all cores by their number, so that all stages
/// together are what the recording takes. Cores that have nothing to do wait for the stages that run meanwhile, in
/// equal parts.
struct StageCost {
    double work = 0;         // as recorded
    double exchange = 0;     // by what blocks take longer than alone
    double handing_out = 0;  // until a core has its first block, counters, barriers
    double alone = 0;        // others wait while one core does what is serial
    double tail = 0;         // others wait for the last blocks of loops, and for phases
    double sum() const { return work + exchange + handing_out + alone + tail; }
    StageCost& operator+=(const StageCost& other);
};
/// By stage; the last is what lies between graphs.
std::vector<StageCost> stage_costs(const Recording& recording, int cores, const MachineModel& machine,
                                   const Traffic& traffic = {});

}  // namespace skerry::profiling
