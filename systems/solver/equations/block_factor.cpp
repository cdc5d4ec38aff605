#include "systems/solver/equations/block_factor.h"

#include <algorithm>
#include <span>

namespace skerry {

void BlockFactor::start() {
    size_.clear();
    first_right_.clear();
    right_.clear();
}

Index BlockFactor::add_part(Index size) {
    size_.push_back(size);
    first_right_.push_back(right_.size());
    right_.resize(right_.size() + static_cast<std::size_t>(size));
    return part_count() - 1;
}

void BlockFactor::close_parts() {
    coupled_.assign(size_.size() * size_.size(), 0);
    for (Index g = 0; g < part_count(); ++g) coupled_[pair(g, g)] = 1;
}

void BlockFactor::couple(Index g, Index h) {
    coupled_[pair(g, h)] = coupled_[pair(h, g)] = 1;
}

/// Returns the remaining part (group of unknowns) that is cheapest to eliminate; of several equally cheap parts the
/// first. The cost of a part with n unknowns, coupled to m unknowns of remaining parts, is estimated as n (n + m)^2.
Index BlockFactor::next_to_eliminate() const {
    Index next = no_index;
    Real least = infinity;
    for (Index g = 0; g < part_count(); ++g) {
        if (rank_[static_cast<std::size_t>(g)] != no_index) continue;
        const Real own = size(g), all = own + coupled_size_[static_cast<std::size_t>(g)];
        if (!(own * all * all < least)) continue;
        least = own * all * all;
        next = g;
    }
    return next;
}

/// Eliminates the part (group of unknowns) `next` in the pattern of nonzero blocks: all remaining parts that are
/// coupled to `next` become coupled to each other.
void BlockFactor::eliminate_pattern(Index next) {
    rank_[static_cast<std::size_t>(next)] = static_cast<Index>(order_.size());
    order_.push_back(next);
    const std::size_t begin = later_.item.size();
    for (Index h = 0; h < part_count(); ++h)
        if (rank_[static_cast<std::size_t>(h)] == no_index && coupled_[pair(next, h)] != 0) later_.item.push_back(h);
    later_.offset.push_back(static_cast<Index>(later_.item.size()));
    for (std::size_t a = begin; a < later_.item.size(); ++a) {
        const Index h = later_.item[a];
        coupled_size_[static_cast<std::size_t>(h)] -= size(next);
        for (std::size_t b = begin; b < later_.item.size(); ++b) {
            const Index k = later_.item[b];
            if (coupled_[pair(h, k)] != 0) continue;
            coupled_[pair(h, k)] = 1;
            coupled_size_[static_cast<std::size_t>(h)] += size(k);
        }
    }
}

bool BlockFactor::analyse() {
    constexpr Real most_numbers = 32 << 20;  // limit on the entries of the factor: 256 MiB in numbers of 8 bytes
    const std::size_t count = size_.size();
    coupled_size_.assign(count, 0);
    for (Index g = 0; g < part_count(); ++g)
        for (Index h = 0; h < part_count(); ++h)
            if (h != g && coupled_[pair(g, h)] != 0) coupled_size_[static_cast<std::size_t>(g)] += size(h);
    rank_.assign(count, no_index);
    order_.clear();
    later_.clear();
    later_.offset.push_back(0);
    work_ = 0;
    Real numbers = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Index next = next_to_eliminate();
        const Real own = size(next), rest = coupled_size_[static_cast<std::size_t>(next)];
        work_ += own * (own * own / 3 + own * rest + rest * rest);
        numbers += own * (own + 2 * rest);
        eliminate_pattern(next);
    }
    if (numbers > most_numbers) return false;
    place_blocks();
    return true;
}

/// Determines the memory layout of the matrix entries, part by part. The entries of a part (group of unknowns) are the
/// diagonal block, the blocks to the right of the diagonal, and the blocks below the diagonal as one matrix.
void BlockFactor::place_blocks() {
    first_.resize(coupled_.size());
    stride_below_.resize(size_.size());
    std::size_t next = 0;
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const Index g = order_[k];
        const auto own = static_cast<std::size_t>(size(g));
        Index rest = 0;
        for (const Index h : later_[k]) rest += size(h);
        stride_below_[static_cast<std::size_t>(g)] = rest;
        first_[pair(g, g)] = next;
        std::size_t right = next + own * own, below = right + own * static_cast<std::size_t>(rest);
        for (const Index h : later_[k]) {
            first_[pair(g, h)] = right;
            first_[pair(h, g)] = below;
            right += own * static_cast<std::size_t>(size(h));
            below += static_cast<std::size_t>(size(h));
        }
        next += own * (own + 2 * static_cast<std::size_t>(rest));
    }
    number_.assign(next, 0);
    pivot_.resize(right_.size());
}

DenseBlock BlockFactor::block(Index g, Index h) {
    const bool above = rank_[static_cast<std::size_t>(g)] <= rank_[static_cast<std::size_t>(h)];
    return {number_.data() + first_[pair(g, h)], size(g), size(h),
            above ? size(g) : stride_below_[static_cast<std::size_t>(h)]};
}

void BlockFactor::multiply(std::span<const Real> blocks, std::span<const Real> x) {
    std::ranges::fill(right_, Real(0));
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const Index g = order_[k];
        const auto add = [&](Index row, Index column) {
            const DenseBlock block_data = block(row, column);
            add_product(block_data, blocks.data() + (block_data.data - number_.data()), x.data() + first(column),
                        right_.data() + first(row));
        };
        add(g, g);
        for (const Index h : later_[k]) add(g, h), add(h, g);
    }
}

bool BlockFactor::solve() {
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const Index g = order_[k];
        const DenseBlock diagonal = block(g, g);
        Index* const pivot = pivot_.data() + first_right_[static_cast<std::size_t>(g)];
        if (!factor_dense(diagonal, pivot)) return false;
        const Index own = size(g);
        solve_dense(diagonal, pivot, {diagonal.data + own * own, own, stride_below_[static_cast<std::size_t>(g)], own});
        solve_dense(diagonal, pivot, right_of(g));
        for (const Index h : later_[k]) {
            const DenseBlock left = block(h, g);
            for (const Index l : later_[k]) subtract_product(left, block(g, l), block(h, l));
            subtract_product(left, right_of(g), right_of(h));
        }
    }
    for (std::size_t k = order_.size(); k-- > 0;)
        for (const Index h : later_[k]) subtract_product(block(order_[k], h), right_of(h), right_of(order_[k]));
    return true;
}

}  // namespace skerry
