#include "profiling/lab/region_solver.h"

#include "components/check.h"
#include "systems/solver/regions/region_blocks.h"
#include "systems/solver/regions/solve_large_regions.h"
#include "systems/solver/regions/solve_region.h"

namespace skerry::lab {

void RegionSolver::solve(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings,
                         Method method, Real h, RegionTable& regions, const RegionOutputs& out) {
    SKERRY_CHECK(!contacts.clustered() && !contacts.rigid.any() && !contacts.implicit.any());
    SolverSettings own = settings;
    own.method = SolverMethod::pcg_pgs;  // makes room for all vectors by contact, without a special form for any region
    const std::size_t region_nodes = find_region_blocks(contacts, regions, memory_);
    memory_.make_room_for(memory_.rows, region_nodes, contacts.inverse_mass.size(), own);
    const RegionStage stage{contacts, own, h, out, memory_};
    const auto solve = [&](const auto& region) {
        const SolveLimits limits = limits_of(own, region.tolerance);
        return solve_loaded(stage, region, [&](auto& op) { return outcome_of(run(method, op, limits), own); });
    };
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto number = static_cast<Index>(r);
        const std::span<const Index> row = regions.contacts[r];
        const Index base = regions.contacts.offset[r];
        RegionOutcome outcome;
        if (row.size() == 1 && !own.fixed_iterations) {
            outcome = solve_single(stage, row[0], base);
        } else if (is_large(stage, regions, number)) {
            team_.gather(executor, [&] {
                order_region(contacts, row, team_, memory_.node_index.span(), coloured_);
                outcome = solve(load_by_colour(stage, row, base, team_, coloured_));
            });
        } else {
            outcome = solve(load_region(stage, row, base));
        }
        write_outcome(outcome, number, regions);
    }
}

}  // namespace skerry::lab
