// Surface properties of pairs of materials, and of parts of the surface of a body. They override the properties of
// bodies and colliders (docs/methods/friction.md 4).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

#include "components/column.h"
#include "components/column_role.h"
#include "components/material_table.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// One row per pair of materials with its own surface properties. Rows are sorted by ascending (first, second).
struct MaterialPairTable {
    Column<Index> first, second;  // rows of MaterialTable, first <= second
    // properties of contacts between the two materials; a negative property is replaced by the mean of both surfaces
    // (mean_surface())
    Column<SurfaceProperties> surface;

    std::size_t size() const { return first.size(); }
    /// Row of the pair of the materials a and b, in either order. If the pair has no row: the row where it would be
    /// inserted.
    std::size_t place_of(Index a, Index b) const {
        const std::pair key(std::min(a, b), std::max(a, b));
        std::size_t begin = 0, end = size();
        while (begin < end) {
            const std::size_t middle = std::midpoint(begin, end);
            if (std::pair(first[middle], second[middle]) < key)
                begin = middle + 1;
            else
                end = middle;
        }
        return begin;
    }
    /// Returns whether `row` exists and belongs to the pair of these two materials.
    bool is_pair(std::size_t row, Index a, Index b) const {
        return row < size() && first[row] == std::min(a, b) && second[row] == std::max(a, b);
    }

    void for_each_column(auto&& visit) {
        visit("first", first, ColumnRole::state);
        visit("second", second, ColumnRole::state);
        visit("surface", surface, ColumnRole::state);
    }
};

/// Parts of body surfaces with their own properties. One row per set of faces and nodes of one body.
struct SurfaceSetTable {
    Column<std::uint32_t> slot;
    Column<Index> body;  // row of BodyTable
    // properties of the surface in the set; for a negative property, that of the body applies
    Column<SurfaceProperties> surface;
    // Direction in the rest shape along which the friction coefficients in `surface` apply; zero: isotropic friction.
    Column<Vec3> direction;
    Column<Real> across;    // friction coefficient across `direction` divided by that along `direction`, > 0
    Column<Range> members;  // range of rows in the column `member`
    // Faces and nodes of all sets, with node numbers of the mesh. A face is stored as its three nodes, a single node as
    // three equal numbers.
    Column<std::array<Index, 3>> member;

    std::size_t size() const { return slot.size(); }
    bool any_direction() const {
        return std::ranges::any_of(direction, [](const Vec3& of_set) { return !of_set.isZero(0); });
    }

    std::span<const std::array<Index, 3>> members_of(std::size_t set) const {
        return rows_of(member.span(), members[set]);
    }
    void erase_members_of(std::size_t set) {
        const Range erased = members[set];
        member.erase(static_cast<std::size_t>(erased.begin), static_cast<std::size_t>(erased.size()));
        members[set] = {};
        for (Range& other : members)
            if (other.begin > erased.begin) other = {other.begin - erased.size(), other.end - erased.size()};
    }

    /// Visits the columns with one row per set. The column `member` is visited by for_each_column only.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("body", body, ColumnRole::body);
        visit("surface", surface, ColumnRole::state);
        visit("direction", direction, ColumnRole::state);
        visit("across", across, ColumnRole::state);
        visit("members", members, ColumnRole::link);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("member", member, ColumnRole::state);
    }
};

/// For each row of TriangleTable, EdgeTable and VertexTable: row of SurfaceSetTable of the set that the feature belongs
/// to, or no_index. All columns are empty if there is no set.
struct SetOfFeature {
    Column<Index> triangle, edge, vertex;
};

}  // namespace skerry
