#include "systems/solver/coloured/solve_large_regions.h"

#include <cmath>

#include "systems/solver/coloured/coloured_operator.h"
#include "systems/solver/coloured/load_coloured.h"
#include "systems/solver/coloured/push_out_coloured.h"
#include "systems/solver/lanes/lane_queue.h"
#include "systems/solver/methods/run_method.h"
#include "systems/solver/solve_region.h"

namespace skerry {
namespace {

/// One large region with its part of the memory.
class LargeRegion {
public:
    LargeRegion(const RegionStage& stage, std::span<const Index> row, Index base, Team& team, ColouredRegion& kept)
        : stage_(stage), row_(row), team_(team), kept_(kept) {
        SolverMemory::Data& data = stage.memory;
        const std::size_t first = static_cast<std::size_t>(base), count = row.size();
        order_region(stage.inputs, row, team, data.place.span(), kept);
        const std::size_t nodes = kept.node.size();
        contact_ = data.contact.span().subspan(first, count);
        memory_.contact = contact_;
        memory_.impulse = data.impulse.span().subspan(first, count);
        memory_.velocity = data.velocity.span().subspan(4 * first, nodes);
        memory_.node = kept.node.span();
        memory_.free_velocity = stage.out.velocity_next;
        memory_.scratch = data.scratch.span().subspan(4 * first, nodes);
        for (std::size_t slot = 0; slot < workspace_slots(stage.settings.method); ++slot)
            memory_.workspace[slot] = data.workspace[slot].span().subspan(first, count);
        push_ = {data.push_impulse.span().subspan(first, count), data.push_bias.span().subspan(first, count), memory_.scratch};
    }

    RegionOutcome solve() {
        loaded_ = load_coloured({stage_.inputs, stage_.out.velocity_next, stage_.settings, stage_.h}, row_, team_, kept_, contact_,
                                memory_.impulse, memory_.velocity);
        scale_ = error_scale(loaded_, stage_.inputs.gravity, stage_.h, stage_.settings.tolerance);
        RegionOutcome outcome;
        if (!start(outcome)) outcome = sweep();
        outcome.dissipated = write_back();
        if (outcome.status != RegionStatus::not_finite) push_out();
        return outcome;
    }

private:
    ColouredOperator make_operator() { return {memory_, kept_.order, team_, kept_.partial.span(), stage_.settings.friction, scale_}; }
    Index row_of(std::size_t place) const { return row_[kept_.order.contact[place]]; }

    void take_warm_start() {
        for_ordered_blocks(team_, kept_.order, [&](std::size_t begin, std::size_t end, Index) {
            for (std::size_t i = begin; i < end; ++i) {
                if (contact_[i].node_count == 0) continue;
                memory_.impulse[i] = warm_impulse(contact_[i], stage_.out.impulse[row_of(i)]);
                apply_impulse(contact_[i], memory_.impulse[i], memory_.velocity.data());
            }
        });
    }

    /// As start_region.
    bool start(RegionOutcome& outcome) {
        const SolverSettings& settings = stage_.settings;
        if (loaded_.separate && settings.skip_separating) {
            outcome = {.status = RegionStatus::certified, .shortcut = shortcut_separating};
            return true;
        }
        if (settings.warm_start == WarmStart::off) return false;
        take_warm_start();
        ColouredOperator op = make_operator();
        return start_from_warm_impulse(op, settings, outcome);
    }

    RegionOutcome sweep() {
        const SolverSettings& settings = stage_.settings;
        const SolveLimits limits{settings.tolerance, settings.max_iterations, settings.fixed_iterations, settings.relaxation};
        ColouredOperator op = make_operator();
        const SolveResult result = run_method(settings.method, op, limits);
        RegionStatus status = result.converged ? RegionStatus::converged : RegionStatus::iteration_limit;
        if (!std::isfinite(result.error)) status = RegionStatus::not_finite;
        op.impulse();  // what waits for a next sweep
        return {.iterations = result.iterations, .error = result.error, .status = status};
    }

    /// Writes impulses and velocities, and returns what the region dissipated.
    Real write_back() {
        for_row_blocks(team_, memory_.node.size(), [&](std::size_t begin, std::size_t end, Index) {
            for (std::size_t n = begin; n < end; ++n) stage_.out.velocity_next[memory_.node[n]] = memory_.velocity[n].head<3>();
        });
        for_ordered_blocks(team_, kept_.order, [&](std::size_t begin, std::size_t end, Index block) {
            Real dissipated = 0;
            for (std::size_t i = begin; i < end; ++i) {
                stage_.out.impulse[row_of(i)] = memory_.impulse[i].head<3>();
                dissipated += dissipated_by(stage_, row_of(i));
            }
            kept_.dissipated[block] = dissipated;
        });
        Real dissipated = 0;
        for (std::size_t block = 0; block < partial_count(kept_.order); ++block) dissipated += kept_.dissipated[block];
        return dissipated;
    }

    void push_out() {
        if (!push_out_coloured(team_, {kept_.order, contact_, memory_.velocity, kept_.partial.span()}, row_, stage_.inputs.gap,
                               stage_.inputs.gravity, stage_.settings, stage_.h, push_))
            return;
        for_row_blocks(team_, memory_.node.size(), [&](std::size_t begin, std::size_t end, Index) {
            for (std::size_t n = begin; n < end; ++n) stage_.out.push_out[memory_.node[n]] = push_.velocity[n].head<3>();
        });
        stage_.memory.pushed.store(true, std::memory_order_relaxed);
    }

    const RegionStage& stage_;
    std::span<const Index> row_;
    Team& team_;
    ColouredRegion& kept_;
    std::span<LumpedContact> contact_;  // by place in the order
    LumpedOperator::Memory memory_;
    PushMemory push_{};
    LoadSums loaded_;
    Real scale_ = 0;  // sqrt(J), of e_nat
};

}  // namespace

void solve_large_regions(Executor& executor, const RegionStage& stage, RegionTable& regions) {
    LargeRegions& large = stage.memory.large;
    std::size_t count = 0;
    for (std::size_t r = 0; r < regions.size(); ++r) count += is_large(stage.settings, regions.contacts[r].size()) ? 1 : 0;
    if (count == 0) return;
    while (large.region.size() < count) large.region.push_back(std::make_unique<ColouredRegion>());
    large.team.gather(executor, [&] {
        std::size_t next = 0;
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (!is_large(stage.settings, regions.contacts[r].size())) continue;
            LargeRegion region(stage, regions.contacts[r], regions.contacts.offset[r], large.team, *large.region[next++]);
            write_outcome(region.solve(), static_cast<Index>(r), regions);
        }
    });
}

}  // namespace skerry
