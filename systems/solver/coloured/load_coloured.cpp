#include "systems/solver/coloured/load_coloured.h"

#include <cmath>

#include "systems/solver/coloured/coloured_operator.h"

namespace skerry {

LoadedSums load_coloured(const LoadSource& source, std::span<const Index> row, Team& team, ColouredRegion& region,
                         std::span<LumpedContact> contact, std::span<Vec4> impulse, std::span<Vec4> velocity) {
    for_row_blocks(team, region.node.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) velocity[n] = padded(source.velocity_next[region.node[n]]);
    });
    for_ordered_blocks(team, region.order, [&](std::size_t begin, std::size_t end, Index block) {
        LoadSums sums{0, 0, true};
        for (std::size_t i = begin; i < end; ++i) {
            const Index k = region.order.contact[i];
            const Index* next = region.local[k].data();  // in the order in which load_contact asks
            contact[i] =
                load_contact(source.inputs, row[k], source.velocity_next, source.settings, source.h, [&](Index) { return *next++; });
            const Vec4 u = contact_velocity(contact[i], velocity.data());
            sums.energy += contact[i].inverse_diagonal * u.squaredNorm();
            sums.inverse_diagonals += contact[i].inverse_diagonal;
            sums.separate &= contact[i].node_count == 0 || separates(contact[i], source.settings.friction, u);
            impulse[i].setZero();
        }
        region.loaded[block] = sums;
    });
    LoadSums sums{0, 0, true};
    for (std::size_t block = 0; block < partial_count(region.order); ++block) {
        sums.energy += region.loaded[block].energy;
        sums.inverse_diagonals += region.loaded[block].inverse_diagonals;
        sums.separate &= region.loaded[block].separate;
    }
    // methods.md 2.1; the floor keeps a region at rest from being asked for more than its weight makes sense of
    const Real floor = 1e-3 * source.inputs.gravity * source.h * std::sqrt(sums.inverse_diagonals);
    return {std::max(std::sqrt(sums.energy), floor), sums.separate};
}

}  // namespace skerry
