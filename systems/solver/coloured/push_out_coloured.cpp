#include "systems/solver/coloured/push_out_coloured.h"

#include <algorithm>

namespace skerry {
namespace {

Real sum_of_sizes(const ColouredPush& region) {
    Real sum = 0;
    for (std::size_t block = 0; block < partial_count(region.order); ++block) sum += region.partial[block].size;
    return sum;
}

}  // namespace

bool push_out_coloured(Team& team, const ColouredPush& region, std::span<const Index> row, std::span<const Real> gap, Real gravity,
                       const SolverSettings& settings, Real h, const PushMemory& memory) {
    const Real slop = push_slop(gravity, h);
    if (std::none_of(row.begin(), row.end(), [&](Index i) { return gap[i] < -slop; })) return false;
    for_row_blocks(team, memory.velocity.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) memory.velocity[n].setZero();
    });
    for_ordered_blocks(team, region.order, [&](std::size_t begin, std::size_t end, Index block) {
        Real size = 0;  // J, of the push asked for
        for (std::size_t i = begin; i < end; ++i) {
            memory.impulse[i] = 0;
            memory.bias[i] = push_bias(region.contact[i], gap[row[region.order.contact[i]]], slop, region.velocity, settings, h);
            const Real asked = std::min(memory.bias[i], Real(0));
            size += region.contact[i].inverse_diagonal * asked * asked;
        }
        region.partial[block].size = size;
    });
    const Real small = settings.tolerance * settings.tolerance * sum_of_sizes(region);
    for (Index iteration = 1; iteration <= settings.max_iterations; ++iteration) {
        for_ordered_blocks(team, region.order, [&](std::size_t begin, std::size_t end, Index block) {
            Real change = 0;
            for (std::size_t i = begin; i < end; ++i)
                change += push_contact(region.contact[i], memory.bias[i], memory.velocity.data(), memory.impulse[i]);
            region.partial[block].size = change;
        });
        if (sum_of_sizes(region) <= small) break;
    }
    return true;
}

}  // namespace skerry
