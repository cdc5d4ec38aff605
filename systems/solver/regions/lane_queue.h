// Regions that wait for a full batch of their size.
#pragma once

#include "systems/solver/lanes/solve_lane_batch.h"
#include "systems/solver/regions/solve_region.h"

namespace skerry {

/// Whether the settings let regions into lanes at all.
bool lanes_allowed(const SolverSettings& settings);

/// Takes loaded and started regions, solves eight of a size at a time, finishes them and writes their rows of the
/// table. One worker's.
class LaneQueue {
public:
    LaneQueue(const RegionStage& stage, RegionTable& regions) : stage_(stage), regions_(regions) {}

    /// Whether this region may wait here.
    bool takes(const RegionInOrder& region) const;
    void push(Index number, const RegionInOrder& region);
    /// Solves what still waits.
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
