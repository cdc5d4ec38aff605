// A hashed grid of boxes of any size. It finds overlapping boxes in a time that grows linearly with the number of boxes
// if few boxes overlap.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "components/bvh_table.h"
#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Grids whose cell edges are powers of two. A box is stored in the grid whose cells are just wider than its longest
/// edge, in the cell of its lower corner. Any box that overlaps the stored box reaches into this cell or comes closer
/// to it than one cell width. Cells are found by hashing their numbers (Teschner, Heidelberger, Müller, Pomeranets,
/// Gross 2003; grids of several sizes: Mirtich 1996). The next `build` reuses the memory.
class BoxGrid {
public:
    /// Builds the grid. `rows`: the rows of `box` to insert; all of these boxes must be finite. `box` must stay
    /// unchanged while the grid is queried.
    void build(std::span<const Aabb> box, std::span<const Index> rows);

    /// Calls visit(other) once for each row whose box may overlap the box of `row`. If two boxes share a point, exactly
    /// one of them is visited from the other.
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
    using Level = int;  // exponent: the cells of a level have edges of 2^level [m]

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
    Column<Level> levels_;  // levels that hold a box, ascending
    std::size_t bucket_mask_ = 0;
    Column<std::size_t> bucket_begin_;
    Column<Entry> entries_;  // sorted by bucket
    Column<Entry> listed_;   // entries in the order of `rows`
};

}  // namespace skerry
