// A hashed grid of boxes of any size, which finds pairs of overlapping boxes. If few boxes overlap, finding all pairs
// takes a time proportional to the number of boxes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "components/bvh_table.h"
#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Hashed grids that find overlapping boxes, one grid for each cell width that occurs; all widths are powers of two
/// (Teschner, Heidelberger, Müller, Pomeranets, Gross 2003; grids of several sizes: Mirtich 1996).
///
/// Each box is stored once: in the grid with the smallest cells that are wider than its longest edge, in the cell of
/// its lower corner. It extends beyond this cell by less than one cell width. A query therefore visits the cells that
/// its box overlaps, and one more layer of cells on the side of smaller coordinates. The next call of `build` reuses
/// the memory.
class BoxGrid {
public:
    /// Builds the grid from the boxes box[r] for all r in `rows`. These boxes must be finite. `box` must stay unchanged
    /// while the grid is queried.
    void build(std::span<const Aabb> box, std::span<const Index> rows);

    /// Calls visit(other) once for each inserted row after `row` whose box may overlap the box of `row`. Rows in
    /// coarser grids come after `row`, and rows with greater indices in the same grid. A loop over all inserted rows
    /// thus visits each pair of boxes that share a point exactly once.
    template <class Visit>
    void for_each_near(Index row, Visit&& visit) const {
        const Aabb& box = box_[static_cast<std::size_t>(row)];
        const Level own = level_of(box);
        for (std::size_t i = 0; i < levels_.size(); ++i) {
            if (levels_[i] < own) continue;
            const Real edge = std::ldexp(Real(1), levels_[i]);
            const Cell first = cell_at(levels_[i], box.lower - Vec3::Constant(edge), edge);
            const Cell last = cell_at(levels_[i], box.upper, edge);
            for (Cell cell = first; cell.x <= last.x; ++cell.x)
                for (cell.y = first.y; cell.y <= last.y; ++cell.y)
                    for (cell.z = first.z; cell.z <= last.z; ++cell.z)
                        for_each_in(cell, [&](Index other) {
                            if (levels_[i] > own || other > row) visit(other);
                        });
        }
    }

private:
    using Level = int;  // binary exponent: the cells of level n have edges of length 2^n [m]

    struct Cell {
        Level level;
        std::int64_t x, y, z;
        bool operator==(const Cell&) const = default;
    };
    struct Entry {
        Cell cell;
        Index row;
    };

    static Level level_of(const Aabb& box);
    static Cell cell_at(Level level, const Vec3& point, Real edge);

    std::size_t bucket_of(const Cell& cell) const {
        const auto part = [](std::int64_t number, std::uint64_t factor) {
            return static_cast<std::uint64_t>(number) * factor;
        };
        const std::uint64_t mixed = (part(cell.x, 73856093) ^ part(cell.y, 19349663) ^ part(cell.z, 83492791)) +
                                    part(cell.level, 0x9e3779b97f4a7c15);
        return (mixed ^ mixed >> 32) & bucket_mask_;
    }

    template <class Visit>
    void for_each_in(const Cell& cell, Visit&& visit) const {
        const std::size_t bucket = bucket_of(cell);
        for (std::size_t i = bucket_begin_[bucket]; i < bucket_begin_[bucket + 1]; ++i)
            if (entries_[i].cell == cell) visit(entries_[i].row);
    }

    std::span<const Aabb> box_;
    Column<Level> levels_;  // levels with at least one box, ascending
    std::size_t bucket_mask_ = 0;
    Column<std::size_t> bucket_begin_;
    Column<Entry> entries_;  // entries of all buckets, bucket after bucket
    Column<Entry> listed_;   // entries in the order of the argument `rows` of build
};

}  // namespace skerry
