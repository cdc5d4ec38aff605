#include "systems/solver/coloured/load_coloured.h"

#include "systems/solver/coloured/coloured_operator.h"

namespace skerry {

LoadSums load_coloured(const LoadSource& source, std::span<const Index> row, Team& team, ColouredRegion& region,
                       std::span<LumpedContact> contact, std::span<Vec4> impulse, std::span<Vec4> velocity) {
    for_row_blocks(team, region.node.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) velocity[n] = padded(source.velocity_next[region.node[n]]);
    });
    for_ordered_blocks(team, region.order, [&](std::size_t begin, std::size_t end, Index block) {
        LoadSums sums;
        for (std::size_t i = begin; i < end; ++i) {
            const Index k = region.order.contact[i];
            const Index* next = region.local[k].data();  // in the order in which load_contact asks
            contact[i] =
                load_contact(source.inputs, row[k], source.velocity_next, source.settings, source.h, [&](Index) { return *next++; });
            const Vec4 u = contact_velocity(contact[i], velocity.data());
            sums.add(contact[i], source.settings.friction, u);
            impulse[i].setZero();
        }
        region.loaded[block] = sums;
    });
    LoadSums sums;
    for (std::size_t block = 0; block < partial_count(region.order); ++block) sums.add(region.loaded[block]);
    return sums;
}

}  // namespace skerry
