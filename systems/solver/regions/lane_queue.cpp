#include "systems/solver/regions/lane_queue.h"

namespace skerry {

bool lanes_allowed(const SolverSettings& settings) {
    return settings.small_regions_in_lanes && sweeps_accelerated(settings) && settings.friction == Friction::cone;
}

bool LaneQueue::takes(const RegionInOrder& region) const {
    return region.sums.one_friction && region.row.size() > 1 && region.row.size() <= largest_lane_region;
}

void LaneQueue::push(Index number, const RegionInOrder& region) {
    const std::size_t size_class = lane_size_class(region.row.size());
    Batch& batch = batch_[size_class];
    batch.waiting[batch.count++] = {number, region};
    if (batch.count == element_lanes) solve(size_class);
}

void LaneQueue::flush() {
    for (std::size_t c = 0; c < batch_.size(); ++c)
        if (batch_[c].count > 0) solve(c);
}

void LaneQueue::solve(std::size_t size_class) {
    Batch& batch = batch_[size_class];
    const SolverSettings& settings = stage_.settings;
    std::array<LaneRegion, element_lanes> lane;
    std::array<LaneResult, element_lanes> result;
    for (std::size_t l = 0; l < batch.count; ++l) {
        const LumpedMemory& memory = batch.waiting[l].region.memory;
        lane[l] = {memory.contact,     memory.workspace[free_velocity_slot], memory.impulse,
                   memory.node.size(), batch.waiting[l].region.scale,        batch.waiting[l].region.tolerance};
    }
    solve_lane_batch(size_class, {lane.data(), batch.count}, settings.max_iterations, settings.relaxation, result);
    for (std::size_t l = 0; l < batch.count; ++l) {
        const RegionInOrder& region = batch.waiting[l].region;
        LumpedOperator op = operator_of(stage_, region);
        RegionOutcome outcome;
        if (result[l].solved) {
            op.refresh();
            outcome = {.iterations = result[l].iterations, .error = result[l].error, .shortcut = shortcut_in_lanes};
        } else {
            outcome = sweep_in_order(stage_, region, op);
        }
        finish_region(stage_, region, op, outcome);
        write_outcome(outcome, batch.waiting[l].number, regions_);
    }
    batch.count = 0;
}

}  // namespace skerry
