#include "profiling/lab/region_solver.h"

#include "components/check.h"
#include "systems/solver/regions/region_blocks.h"
#include "systems/solver/regions/solve_large_regions.h"
#include "systems/solver/regions/solve_region.h"

namespace skerry::lab {
namespace {

template <RegionWalk Walk>
RegionOutcome solve_loaded(const RegionStage& stage, const LoadedRegion<Walk>& region, Method method) {
    RegionOutcome outcome;
    if (!start_region(stage, region, outcome)) {
        LumpedOperatorBy<Walk> op = operator_of(stage, region);
        outcome = outcome_of(run(method, op, limits_of(stage.settings, region.tolerance)), stage.settings);
    }
    finish_region(stage, region, outcome);
    return outcome;
}

}  // namespace

void RegionSolver::solve(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings,
                         Method method, Real h, RegionTable& regions, const RegionOutputs& out) {
    SKERRY_CHECK(!contacts.clustered() && !contacts.rigid.any() && !contacts.implicit.any());
    SolverSettings own = settings;
    own.method = SolverMethod::pcg_pgs;  // makes room for all vectors by contact, without a special form for any region
    const std::size_t region_nodes = find_region_blocks(contacts, regions, memory_);
    memory_.make_room_for(memory_.rows, region_nodes, contacts.inverse_mass.size(), own);
    const RegionStage stage{contacts, own, h, out, memory_};
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto number = static_cast<Index>(r);
        const std::span<const Index> row = regions.contacts[r];
        const Index base = regions.contacts.offset[r];
        RegionOutcome outcome;
        if (row.size() == 1 && !own.fixed_iterations) {
            outcome = solve_single(stage, row[0]);
        } else if (is_large(stage, regions, number)) {
            team_.gather(executor, [&] {
                order_region(contacts, row, team_, memory_.place.span(), coloured_);
                outcome = solve_loaded(stage, load_by_colour(stage, row, base, team_, coloured_), method);
            });
        } else {
            outcome = solve_loaded(stage, load_region(stage, row, base), method);
        }
        write_outcome(outcome, number, regions);
    }
}

}  // namespace skerry::lab
