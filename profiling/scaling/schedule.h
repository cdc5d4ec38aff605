// Predicted time of a recording on a number of cores: list scheduling of its pieces with the costs of a machine model.
#pragma once

#include "profiling/scaling/recording.h"

namespace skerry::profiling {

/// Model of a machine. The costs of two virtual cores with one cache were measured on such cores (measure_costs.h,
/// docs/scaling.md). Costs beyond one chiplet were not measured.
struct MachineModel {
    // Time from handing out blocks to the first of them on a worker that looks for work [s]. Measured with oneTBB:
    // 1.5e-6 to 2.5e-6.
    double join = 2e-6;
    // Like `join`, for a worker that sleeps and is woken by the system [s]. Measured: 18e-6 to 37e-6; half as long
    // without a hypervisor.
    double wake_up = 20e-6;
    // Time for which a worker without work looks for some before it sleeps [s]. Measured: between 100e-6 and 200e-6.
    double patience = 150e-6;
    // Cost of a phase of a Team (jobs/team.h) [s].
    double barrier = 0.3e-6;
    // Time for a cache line to go from core to core [s]. It is also the cost of taking a block from a counter from
    // which another worker took the previous block. 20 ns within a chiplet, about 100 ns between chiplets (published
    // measurements of such processors).
    double line_transfer = 20e-9, far_line_transfer = 100e-9;

    int cores_per_chiplet = 8;
    double cache_per_chiplet = 32e6;  // last level of the cache [bytes]
    double bandwidth = 370e9;         // of all memory of a socket of 64 cores (twelve channels, sustained) [bytes/s]
    // Rate at which a core reads data last written by another core of its chiplet [bytes/s]. It was fitted to the
    // stages of one scene (scenes/table.json) on two threads. The rate from another chiplet is half of it, a guess.
    double near_rate = 30e9, far_rate = 15e9;
    // Part of the data read by a block of a core's own share that another core has written: a guess. Rows are in the
    // order of bodies in all tables, so shares of different loops cover the same bodies. Pairs reach over to
    // neighbours.
    double own_from_elsewhere = 0.25;

    /// A machine without costs: the limit that the work alone sets.
    static MachineModel free_of_cost();
};

/// Data traffic of the steps, for the share of the bandwidth.
struct Traffic {
    double bytes_per_second = 0;  // of one core alone [bytes/s]
    double working_set = 0;       // data that each step reads [bytes]
};

/// Predicted time of the recording on `cores` cores [s]. A worker takes stages that are ready, then blocks of open
/// loops, first those of its own share, then of the next ones. It stays with a loop until no block is left. The worker
/// that handed out a loop waits for its last block. A Team takes the workers that are free when its first phase begins,
/// up to Team::most_members.
double predict_seconds(const Recording& recording, int cores, const MachineModel& machine, const Traffic& traffic = {});

/// Breakdown of the time of a stage: time of all cores, divided by their number [s]. All stages together thus add up to
/// the time of the recording. The time of idle cores is charged in equal parts to the stages that run meanwhile.
struct StageCost {
    double work = 0;         // as recorded
    double exchange = 0;     // extra time of blocks over running alone: data exchange and shared bandwidth
    double handing_out = 0;  // time until a core has its first block, counters, barriers
    double alone = 0;        // others wait while one core runs serial work
    double tail = 0;         // others wait for the last blocks of loops and for phases
    double sum() const { return work + exchange + handing_out + alone + tail; }
    StageCost& operator+=(const StageCost& other);
};
/// Costs by stage. The last entry is the work between graphs.
std::vector<StageCost> stage_costs(const Recording& recording, int cores, const MachineModel& machine,
                                   const Traffic& traffic = {});

}  // namespace skerry::profiling
