// Sorting of the candidates that a search has found.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "components/lanes.h"
#include "components/pair_table.h"

namespace skerry {

/// Greatest number of candidates that are sorted by counting (a pair of bodies has some hundreds). The place of a
/// candidate is then the number of candidates of the same kind with a lower key. The comparisons run several at a time
/// in a register, faster than the mispredicted branches of a usual sort.
inline constexpr std::size_t counted_at_most = 512;

inline constexpr auto feature_before = [](const FoundCandidate& a, const FoundCandidate& b) {
    return a.candidate.feature < b.candidate.feature;
};

namespace sort_found_detail {

/// The two highest bits of a feature key are the kind of the features. The lower bits give the order of candidates of
/// the same kind.
inline constexpr int kind_shift = 62;
inline std::size_t kind_of(const FoundCandidate& found) {
    return static_cast<std::size_t>(found.candidate.feature >> kind_shift);
}
inline std::int64_t order_of(const FoundCandidate& found) {
    return static_cast<std::int64_t>(found.candidate.feature & ((std::uint64_t{1} << kind_shift) - 1));
}

inline void sort_by_counting(Column<FoundCandidate>& found) {
    typedef std::int64_t Keys __attribute__((vector_size(sizeof(KernelReal))));  // fills a register
    constexpr std::size_t lanes = lanes_of<KernelReal>, kinds = 4;
    std::array<std::array<std::uint16_t, counted_at_most>, kinds> row;
    std::array<std::size_t, kinds> count{};
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::size_t kind = kind_of(found[i]);
        row[kind][count[kind]++] = static_cast<std::uint16_t>(i);
    }
    std::array<Keys, counted_at_most / lanes> order;
    std::array<FoundCandidate, counted_at_most> sorted;
    std::size_t first = 0;
    for (std::size_t kind = 0; kind < kinds; ++kind) {
        const std::size_t blocks = (count[kind] + lanes - 1) / lanes;
        for (std::size_t i = 0; i < lanes * blocks; ++i)  // padding is sorted to the end
            order[i / lanes][i % lanes] =
                i < count[kind] ? order_of(found[row[kind][i]]) : std::numeric_limits<std::int64_t>::max();
        for (std::size_t i = 0; i < count[kind]; ++i) {
            const Keys own = Keys{} + order[i / lanes][i % lanes];
            Keys less{};  // -1 for each candidate with a lower key
            for (std::size_t b = 0; b < blocks; ++b) less += order[b] < own;
            std::int64_t rank = 0;
            for (std::size_t l = 0; l < lanes; ++l) rank -= less[l];
            sorted[first + static_cast<std::size_t>(rank)] = found[row[kind][i]];
        }
        first += count[kind];
    }
    std::copy_n(sorted.begin(), first, found.begin());
}

}  // namespace sort_found_detail

/// Sorts candidates in feature order. No feature key may occur twice.
inline void sort_by_feature(Column<FoundCandidate>& found) {
    if (found.size() <= counted_at_most)
        sort_found_detail::sort_by_counting(found);
    else
        std::sort(found.begin(), found.end(), feature_before);
}

}  // namespace skerry
