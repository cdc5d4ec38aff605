// Queue of small regions. A region waits until there are enough regions of similar size to fill all SIMD lanes.
#pragma once

#include "systems/solver/lanes/solve_lane_batch.h"
#include "systems/solver/regions/solve_region.h"

namespace skerry {

/// True if the settings allow solving regions in SIMD lanes.
bool lanes_allowed(const SolverSettings& settings);

/// Queue of regions for which load_region() and start_region() have run. It solves eight regions of one size class at a
/// time, finishes them and writes their rows of RegionTable. A queue belongs to one task, and thus to one worker.
class LaneQueue {
public:
    LaneQueue(const RegionStage& stage, RegionTable& regions) : stage_(stage), regions_(regions) {}

    /// True if the queue can solve this region: it is small and has at least two contacts, no ties, and equal static
    /// and dynamic friction.
    bool takes(const RegionInOrder& region) const;
    void push(Index number, const RegionInOrder& region);
    /// Solves the regions that are still waiting.
    void flush();

private:
    struct Waiting {
        Index number;
        RegionInOrder region;
    };
    struct Batch {
        std::array<Waiting, element_lanes> waiting;
        std::size_t count = 0;
    };

    void solve(std::size_t size_class);

    const RegionStage& stage_;
    RegionTable& regions_;
    std::array<Batch, lane_sizes.size()> batch_;
};

}  // namespace skerry
