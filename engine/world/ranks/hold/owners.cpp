#include "engine/world/ranks/hold/owners.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "components/box_grid.h"
#include "components/split_mix.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

/// Position of a cell along the Hilbert curve through 2^21 cells in each direction (Skilling 2004, Programming the
/// Hilbert curve).
std::uint64_t hilbert_position(std::array<std::uint32_t, 3> cell) {
    constexpr std::uint32_t top = std::uint32_t{1} << 20;
    for (std::uint32_t bit = top; bit > 1; bit >>= 1)
        for (std::uint32_t& axis : cell) {
            const std::uint32_t low = bit - 1;
            if (axis & bit) {
                cell[0] ^= low;
            } else {
                const std::uint32_t swapped = (cell[0] ^ axis) & low;
                cell[0] ^= swapped;
                axis ^= swapped;
            }
        }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    std::uint32_t turned = 0;
    for (std::uint32_t bit = top; bit > 1; bit >>= 1)
        if (cell[2] & bit) turned ^= bit - 1;
    std::uint64_t position = 0;
    for (std::uint32_t bit = top; bit > 0; bit >>= 1)
        for (const std::uint32_t axis : cell) position = position << 1 | ((axis ^ turned) & bit ? 1u : 0u);
    return position;
}

/// A unit, which is a set of bodies that joints or similar rows connect (WholeWorld::unit), with the sum of the costs
/// and the bounding box of its bodies.
struct UnitExtent {
    Index unit;
    Real cost = 0;
    Aabb box = empty_box();
};

std::vector<UnitExtent> extents_of_units(const WholeWorld& whole, std::span<const BodyExtent> extents) {
    std::vector<Index> row(whole.size(), no_index);
    std::vector<UnitExtent> units;
    for (const BodyExtent& body : extents) {
        const auto unit = static_cast<std::size_t>(whole.unit[body.world_row]);
        if (row[unit] == no_index) {
            row[unit] = static_cast<Index>(units.size());
            units.push_back({.unit = static_cast<Index>(unit)});
        }
        UnitExtent& of_unit = units[static_cast<std::size_t>(row[unit])];
        of_unit.cost += body.cost;
        grow(of_unit.box, body.box);
    }
    return units;
}

/// Sorts units along the Hilbert curve through the box of their centres.
void sort_along_curve(std::vector<UnitExtent>& units) {
    const auto centre = [](const UnitExtent& unit) { return Vec3((unit.box.lower + unit.box.upper) / 2); };
    Aabb all = empty_box();
    for (const UnitExtent& unit : units) grow(all, centre(unit));
    const Real edge = std::max((all.upper - all.lower).maxCoeff(), std::numeric_limits<Real>::min());
    constexpr Real cells = (1 << 21) - 1;
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t u = 0; u < units.size(); ++u) {
        const Vec3 at = (centre(units[u]) - all.lower) / edge * cells;
        order.emplace_back(hilbert_position({static_cast<std::uint32_t>(at.x()), static_cast<std::uint32_t>(at.y()),
                                             static_cast<std::uint32_t>(at.z())}),
                           u);
    }
    std::ranges::sort(order);
    std::vector<UnitExtent> sorted;
    for (const auto& [position, u] : order) sorted.push_back(units[u]);
    units = std::move(sorted);
}

}  // namespace

Column<std::int32_t> choose_owners(const WholeWorld& whole, std::span<const BodyExtent> extents,
                                   const RankSettings& settings, int rank_count) {
    std::vector<UnitExtent> units = extents_of_units(whole, extents);
    if (settings.map == OwnerMap::curve) sort_along_curve(units);
    Real total = 0;
    for (const UnitExtent& unit : units) total += unit.cost;
    std::vector<std::int32_t> owner_of_unit(whole.size(), 0);
    SplitMix random{settings.seed};
    Real cost_before = 0;
    std::int32_t turn = 0;
    for (const UnitExtent& unit : units) {
        std::int32_t& owner = owner_of_unit[static_cast<std::size_t>(unit.unit)];
        switch (settings.map) {
            case OwnerMap::curve:
                owner = std::min(static_cast<std::int32_t>((cost_before + unit.cost / 2) / total * rank_count),
                                 rank_count - 1);
                cost_before += unit.cost;
                break;
            case OwnerMap::round_robin:
                owner = turn++ % rank_count;
                break;
            case OwnerMap::random:
                owner = static_cast<std::int32_t>(random.next() % static_cast<std::uint64_t>(rank_count));
                break;
        }
    }
    Column<std::int32_t> owners = whole.owner;
    for (std::size_t world_row = 0; world_row < owners.size(); ++world_row)
        if (owners[world_row] != WholeWorld::everywhere)
            owners[world_row] = owner_of_unit[static_cast<std::size_t>(whole.unit[world_row])];
    return owners;
}

Real imbalance(std::span<const std::int32_t> owner, std::span<const BodyExtent> extents, int rank_count) {
    std::vector<Real> cost(static_cast<std::size_t>(rank_count), 0);
    for (const BodyExtent& body : extents)
        cost[static_cast<std::size_t>(owner[static_cast<std::size_t>(body.world_row)])] += body.cost;
    const Real total = std::accumulate(cost.begin(), cost.end(), Real(0));
    return total > 0 ? std::ranges::max(cost) * rank_count / total : 1;
}

std::vector<std::vector<int>> find_holding_ranks(const WholeWorld& whole, std::span<const std::int32_t> owner,
                                                 std::span<const BodyExtent> extents, int rank_count) {
    const auto owner_of = [&](Index world_row) { return owner[static_cast<std::size_t>(world_row)]; };
    std::vector<std::vector<int>> holders_of_unit(whole.size());
    const auto hold = [&](Index world_row, Index other) {
        holders_of_unit[static_cast<std::size_t>(whole.unit[world_row])].push_back(owner_of(other));
    };
    Column<Aabb> boxes;
    Column<Index> rows;
    for (const BodyExtent& body : extents) {
        rows.push_back(static_cast<Index>(boxes.size()));
        boxes.push_back(body.box);
        hold(body.world_row, body.world_row);
        if (!body.on_all) continue;
        std::vector<int>& ranks = holders_of_unit[static_cast<std::size_t>(whole.unit[body.world_row])];
        for (int rank = 0; rank < rank_count; ++rank) ranks.push_back(rank);
    }
    BoxGrid grid;
    grid.build(boxes, rows);
    for (const Index row : rows)
        grid.for_each_near(row, [&](Index other) {
            const Index a = extents[static_cast<std::size_t>(row)].world_row,
                        b = extents[static_cast<std::size_t>(other)].world_row;
            if (owner_of(a) == owner_of(b) || distance_squared(boxes[row], boxes[other]) > 0) return;
            hold(a, b);
            hold(b, a);
        });
    for (std::vector<int>& ranks : holders_of_unit) {
        std::ranges::sort(ranks);
        ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    }
    std::vector<std::vector<int>> holders(whole.size());
    for (const BodyExtent& body : extents)
        holders[static_cast<std::size_t>(body.world_row)] =
            holders_of_unit[static_cast<std::size_t>(whole.unit[body.world_row])];
    return holders;
}

}  // namespace skerry
