#include "systems/solver/solve_regions.h"

#include <algorithm>

#include "components/check.h"
#include "systems/solver/schedule_regions.h"
#include "systems/solver/solve_region.h"
#include "systems/solver/solver_memory.h"

namespace skerry {
namespace {

void make_room_for(const RegionTable& regions, std::size_t node_count, const SolverSettings& settings, SolverMemory::Data& memory) {
    const std::size_t contacts = regions.contacts.item.size();
    make_room(memory.contact, contacts);
    make_room(memory.impulse, contacts);
    make_room(memory.push_impulse, contacts);
    make_room(memory.push_bias, contacts);
    make_room(memory.node, 4 * contacts);
    make_room(memory.velocity, 4 * contacts);
    make_room(memory.scratch, 4 * contacts);
    make_room(memory.place, node_count);
    for (std::size_t slot = 0; slot < workspace_slots(settings.method); ++slot) make_room(memory.workspace[slot], contacts);
}

void solve_task(const RegionStage& stage, const RegionTask& task, RegionTable& regions) {
    for (Index k = task.begin; k < task.end; ++k) {
        const Index region = regions.order[k];
        const std::span<const Index> row = regions.contacts[region];
        const bool closed_form = row.size() == 1 && !stage.settings.fixed_iterations;
        const RegionOutcome outcome = closed_form ? solve_single(stage, row[0]) : solve_region(stage, row, regions.contacts.offset[region]);
        regions.iterations[region] = outcome.iterations;
        regions.error[region] = outcome.error;
        regions.status[region] = outcome.status;
        regions.dissipated[region] = outcome.dissipated;
    }
}

}  // namespace

SolverMemory::SolverMemory() : data_(std::make_unique<Data>()) {}
SolverMemory::~SolverMemory() = default;

bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h, SolverMemory& memory,
                   RegionTable& regions, const RegionOutputs& out) {
    SKERRY_CHECK(h > 0 && settings.max_iterations >= 1);
    SKERRY_CHECK(out.impulse.size() == contacts.stencil.size() && contacts.normal.size() == contacts.stencil.size());
    SKERRY_CHECK(out.velocity_next.size() == contacts.inverse_mass.size() && out.push_out.size() == contacts.inverse_mass.size());
    SolverMemory::Data& data = memory.data();
    // advance_positions has used the last push; a refused step has not
    if (data.pushed.exchange(false)) std::fill(out.push_out.begin(), out.push_out.end(), Vec3::Zero());
    const std::size_t region_count = regions.size();
    regions.iterations.resize(region_count);
    regions.error.resize(region_count);
    regions.status.resize(region_count);
    regions.dissipated.resize(region_count);
    regions.order.resize(region_count);
    if (region_count == 0) return false;

    make_room_for(regions, contacts.inverse_mass.size(), settings, data);
    schedule_regions(settings, regions, data.task);
    const RegionStage stage{contacts, settings, h, out, data};
    // regions that share a node (the paper's algorithm makes some) see each other's result: one after the other, in order
    if (!regions.independent || data.task.size() == 1) {
        for (const RegionTask& task : data.task) solve_task(stage, task, regions);
        return true;
    }
    executor.run_blocks(static_cast<Index>(data.task.size()), [&](Index t) { solve_task(stage, data.task[t], regions); });
    return true;
}

}  // namespace skerry
