#include "components/box_grid.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace skerry {

/// Exponent of the smallest power of two above the longest edge of the box. Rounding of the edge length never makes it
/// too small: a length of at least 2^n is not rounded below 2^n, because 2^n is representable.
BoxGrid::Level BoxGrid::level_of(const Aabb& box) {
    // Limits of the edge length [m]. They ensure that the edges of cells are finite and above zero.
    constexpr Real min_extent = std::numeric_limits<Real>::min(), max_extent = 0x1p1000;
    int level = 0;
    std::frexp(std::clamp((box.upper - box.lower).maxCoeff(), min_extent, max_extent), &level);
    return level;
}

/// Cell that contains the point. Despite rounding errors, cell numbers increase monotonically with the coordinate: the
/// greater of two coordinates never gets the smaller number.
BoxGrid::Cell BoxGrid::cell_at(Level level, const Vec3& point, Real edge) {
    constexpr Real max_cell = 0x1p62;  // greatest cell number; points further from the origin also get this number
    const auto number = [&](Real coordinate) {
        return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / edge), -max_cell, max_cell));
    };
    return {level, number(point[0]), number(point[1]), number(point[2])};
}

void BoxGrid::build(std::span<const Aabb> box, std::span<const Index> rows) {
    box_ = box;
    bucket_mask_ = std::bit_ceil(2 * rows.size() + 1) - 1;
    bucket_begin_.assign(bucket_mask_ + 2, 0);
    levels_.clear();
    listed_.resize(rows.size());
    entries_.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Aabb& own = box[static_cast<std::size_t>(rows[i])];
        const Level level = level_of(own);
        if (std::find(levels_.begin(), levels_.end(), level) == levels_.end()) levels_.push_back(level);
        listed_[i] = {cell_at(level, own.lower, std::ldexp(Real(1), level)), rows[i]};
        ++bucket_begin_[bucket_of(listed_[i].cell) + 1];
    }
    std::sort(levels_.begin(), levels_.end());
    for (std::size_t b = 1; b < bucket_begin_.size(); ++b) bucket_begin_[b] += bucket_begin_[b - 1];
    // Filling a bucket increments its begin until it equals the begin of the next bucket. Shifting all begins by one
    // bucket then restores their original values.
    for (const Entry& entry : listed_) entries_[bucket_begin_[bucket_of(entry.cell)]++] = entry;
    std::copy_backward(bucket_begin_.begin(), bucket_begin_.end() - 1, bucket_begin_.end());
    bucket_begin_[0] = 0;
}

}  // namespace skerry
