#include "systems/solver/solve_regions.h"

#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/solver/regions/body_region.h"
#include "systems/solver/regions/lane_queue.h"
#include "systems/solver/regions/region_blocks.h"
#include "systems/solver/regions/solve_large_regions.h"
#include "systems/solver/schedule_regions.h"

namespace skerry {
namespace {

constexpr std::size_t cleared_per_block = 4096;  // chosen so that a block takes a few microseconds

void solve_task(const RegionStage& stage, const RegionTask& task, bool lanes, RegionTable& regions) {
    LaneQueue queue(stage, regions);
    for (Index k = task.begin; k < task.end; ++k) {
        const Index number = regions.order[k];
        if (is_large(stage, regions, number)) continue;
        const std::span<const Index> row = regions.contacts[number];
        const Index base = regions.contacts.offset[number];
        RegionOutcome outcome;
        if (needs_blocks(stage.memory, regions, number)) {
            const auto r = static_cast<std::size_t>(number);
            outcome = solve_bodies(stage, {row, regions.joints_of(r), regions.cables_of(r)}, number, base);
        } else if (touches_cluster(stage.memory, number)) {
            outcome = solve_clustered(stage, row, number, base);
        } else if (row.size() == 1 && !stage.settings.fixed_iterations) {
            outcome = solve_single(stage, row[0], base);
        } else {
            const RegionInOrder region = load_region(stage, row, base);
            LumpedOperator op = operator_of(stage, region);
            if (!start_region(stage, region, op, outcome)) {
                if (lanes && queue.takes(region)) {
                    queue.push(number, region);
                    continue;
                }
                outcome = sweep_in_order(stage, region, op);
            }
            finish_region(stage, region, op, outcome);
        }
        write_outcome(outcome, number, regions);
    }
    queue.flush();
}

void make_room_for_cables(const SolvedCables& cables, RegionMemory& data) {
    if (cables.block.empty()) return;
    const CableBlock& last = cables.block.back();
    const auto impulses = static_cast<std::size_t>(last.impulses());
    make_room(data.cable_law, cables.block.size());
    make_room(data.cable_mobility, static_cast<std::size_t>(last.mobility) + impulses * impulses);
    make_room(data.cable_numbers, CableLaw::numbers_by_segment * cables.stencil.size());
}

void make_rows(RegionTable& regions) {
    const std::size_t count = regions.size();
    regions.iterations.resize(count);
    regions.error.resize(count);
    regions.status.resize(count);
    regions.shortcut.resize(count);
    regions.dissipated.resize(count);
    regions.push_work.resize(count);
    regions.order.resize(count);
}

void solve_tasks(Executor& executor, const RegionStage& stage, RegionTable& regions) {
    solve_large_regions(executor, stage, regions);
    const Column<RegionTask>& tasks = stage.memory.task;
    const bool lanes = lanes_allowed(stage.settings);
    if (tasks.size() == 1) {
        solve_task(stage, tasks[0], lanes, regions);
        return;
    }
    executor.run_blocks(static_cast<Index>(tasks.size()),
                        [&](Index t) { solve_task(stage, tasks[t], lanes, regions); });
}

}  // namespace

SolverMemory::SolverMemory() : data_(std::make_unique<RegionMemory>()) {}
SolverMemory::~SolverMemory() = default;
void SolverMemory::note_push() {
    data_->pushed = true;
}

bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h,
                   SolverMemory& memory, RegionTable& regions, const RegionOutputs& out) {
    SKERRY_CHECK(h > 0 && settings.max_iterations >= 1);
    SKERRY_CHECK(out.impulse.size() == contacts.stencil.size() && contacts.normal.size() == contacts.stencil.size());
    SKERRY_CHECK(out.velocity_next.size() == contacts.inverse_mass.size() &&
                 out.push_out.size() == contacts.inverse_mass.size());
    RegionMemory& data = memory.data();
    // Clear the pseudo velocities of the last step. advance_positions has already used the pseudo velocities, or the
    // step was rejected.
    if (data.pushed.exchange(false))
        parallel_for(executor, out.push_out.size(), cleared_per_block, [&](std::size_t begin, std::size_t end) {
            std::fill(out.push_out.begin() + begin, out.push_out.begin() + end, Vec3::Zero());
        });
    regions.pushed = false;
    make_rows(regions);
    recall_regions(executor, contacts.key, data, regions);
    if (regions.size() == 0) {
        remember_regions(data, regions);
        return false;
    }
    const std::size_t region_nodes = find_region_blocks(contacts, regions, data);
    data.make_room_for(data.rows, region_nodes, contacts.inverse_mass.size(), settings);
    if (contacts.rigid.any() || !contacts.cables.block.empty() || !contacts.friction_axis.empty()) {
        data.make_room_for_rigid(data.rows, region_nodes, settings.method);
        data.newton.make_room(static_cast<std::size_t>(executor.worker_count()));
        data.runs.make_room(static_cast<std::size_t>(executor.worker_count()));
    }
    make_room(data.joint_law, data.rows - data.contact_rows);
    make_room_for_cables(contacts.cables, data);
    schedule_regions(executor, settings, data, regions);
    solve_tasks(executor, {contacts, settings, h, out, data}, regions);
    regions.pushed = data.pushed.load(std::memory_order_relaxed);
    remember_regions(data, regions);
    return true;
}

}  // namespace skerry
