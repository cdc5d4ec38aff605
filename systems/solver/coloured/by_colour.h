// Parallel traversal of a large region: a team of workers visits the contacts in the order of a colouring
// (colour_contacts.h). Results do not depend on the number of workers: the impulses are those of one thread in this
// order, bit by bit, and sums over contacts are added block by block.
#pragma once

#include <algorithm>
#include <span>
#include <tuple>

#include "jobs/team.h"
#include "systems/solver/coloured/colour_contacts.h"
#include "systems/solver/local/load_sums.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Number of rows in one block of a parallel loop over nodes, or over contacts that are not ordered yet. With this
/// size, copying the rows of a block (32 bytes each) takes several times as long as claiming the block.
inline constexpr std::size_t row_block = 256;

inline Index row_block_count(std::size_t rows) {
    return static_cast<Index>((rows + row_block - 1) / row_block);
}

/// Calls body(begin, end, block) for consecutive blocks of row_block rows.
template <class Body>
void for_row_blocks(Team& team, std::size_t count, Body&& body) {
    team.run_blocks(row_block_count(count), [&](Index block) {
        const std::size_t begin = static_cast<std::size_t>(block) * row_block;
        body(begin, std::min(begin + row_block, count), block);
    });
}

/// Partial sums over the contacts of one block. The tuple has one entry for each type of sum.
using BlockSum = std::tuple<Real, SweepChange, LoadSums>;

/// Number of blocks of a coloured order.
inline std::size_t block_count(const ColouredOrder& order) {
    return order.block_offset.size() - 1;
}

class ByColour {
public:
    static constexpr bool own_masses = true;

    /// The span `partial` must have block_count(order) rows.
    ByColour(const ColouredOrder& order, Team& team, std::span<BlockSum> partial)
        : order_(&order), team_(&team), partial_(partial) {}

    std::size_t number_of(std::size_t position) const { return static_cast<std::size_t>(order_->contact[position]); }
    /// A caller of contacts() accepts any order. This function visits the phases of the coloured order one after the
    /// other, as a sweep must. Each worker then gets the same contacts as in a sweep and finds them in its cache.
    template <class Body>
    void contacts(std::size_t, Body&& body) const {
        for_blocks([&body](std::size_t begin, std::size_t end, Index) { body(begin, end); });
    }
    template <class Body>
    void nodes(std::size_t count, Body&& body) const {
        for_row_blocks(*team_, count, [&body](std::size_t begin, std::size_t end, Index) { body(begin, end); });
    }
    template <class Sum, class Part>
    Sum sum(std::size_t, Part&& part) const {
        for_blocks([this, &part](std::size_t begin, std::size_t end, Index block) {
            std::get<Sum>(partial_[block]) = part(begin, end);
        });
        Sum sum{};
        for (std::size_t block = 0; block < block_count(*order_); ++block) sum += std::get<Sum>(partial_[block]);
        return sum;
    }

    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        apply_impulse(contact, impulse, velocity);
    }
    Real coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b); }

private:
    template <class Body>
    void for_blocks(Body&& body) const {
        team_->run_phases(order_->phase_offset.span(), [&](Index block) {
            body(static_cast<std::size_t>(order_->block_offset[block]),
                 static_cast<std::size_t>(order_->block_offset[block + 1]), block);
        });
    }

    const ColouredOrder* order_;
    Team* team_;
    std::span<BlockSum> partial_;
};

using ColouredOperator = LumpedOperatorBy<ByColour>;
static_assert(ContactOperator<ColouredOperator>);
// These templates are instantiated once, in by_colour.cpp.
extern template class RegionOperatorBase<ColouredOperator, ByColour, LumpedMemory>;
extern template class LumpedOperatorBy<ByColour>;

}  // namespace skerry
