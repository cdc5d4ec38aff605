#include "systems/solver/lanes/solve_lane_batch.h"

#include "components/check.h"
#include "systems/solver/lanes/solve_lanes.h"

namespace skerry {
namespace {

template <int K>
void solve_padded(std::span<const LaneRegion> region, Index max_iterations, Real relaxation,
                  std::span<LaneResult> result) {
    LaneProblem<Real8, K> problem;
    clear(problem);
    LaneMask<Real8> filled{};
    for (std::size_t l = 0; l < region.size(); ++l) {
        const int lane = static_cast<int>(l);
        fill_lane(region[l], lane, problem);
        filled[lane] = -1;
    }
    const LaneOutcome<Real8> outcome =
        solve_lanes<Real8, K>(problem, filled, std::min(max_iterations, lane_sweep_limit), relaxation);
    for (std::size_t l = 0; l < region.size(); ++l) {
        const int lane = static_cast<int>(l);
        result[l] = {static_cast<Index>(outcome.iterations[lane]), outcome.error[lane], outcome.solved[lane] != 0};
        if (!result[l].solved) continue;
        for (std::size_t i = 0; i < region[l].impulse.size(); ++i)
            region[l].impulse[i] = lane_of(problem.impulse[i], lane);
    }
}

}  // namespace

void solve_lane_batch(std::size_t size_class, std::span<const LaneRegion> region, Index max_iterations, Real relaxation,
                      std::span<LaneResult> result) {
    SKERRY_CHECK(region.size() <= element_lanes && result.size() >= region.size());
    switch (lane_sizes[size_class]) {
        case 2:
            return solve_padded<2>(region, max_iterations, relaxation, result);
        case 3:
            return solve_padded<3>(region, max_iterations, relaxation, result);
        case 4:
            return solve_padded<4>(region, max_iterations, relaxation, result);
        case 6:
            return solve_padded<6>(region, max_iterations, relaxation, result);
        case 8:
            return solve_padded<8>(region, max_iterations, relaxation, result);
        case 12:
            return solve_padded<12>(region, max_iterations, relaxation, result);
        default:
            SKERRY_CHECK(false);
    }
}

}  // namespace skerry
