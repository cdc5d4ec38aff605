// Rows that are removed with bodies and colliders, and the new numbers of all remaining rows. Both are found in one
// pass over the tables, before any table changes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// One value of type T for each table in which a body has rows.
template <class T>
struct OfBodyTables {
    T bodies{}, nodes{}, node_blocks{}, blocks{}, element_nodes{}, tetrahedron_blocks{}, triangles{}, edges{},
        vertices{}, vertex_triangles{}, bvh_nodes{}, bvh_leaves{}, rigid{}, implicit{};

    /// All members of the struct. Code that visits all tables of a body uses this list.
    static constexpr auto members() {
        using Of = OfBodyTables;
        return std::array{&Of::bodies,        &Of::nodes,     &Of::node_blocks,        &Of::blocks,
                          &Of::element_nodes, &Of::edges,     &Of::tetrahedron_blocks, &Of::triangles,
                          &Of::vertices,      &Of::bvh_nodes, &Of::vertex_triangles,   &Of::bvh_leaves,
                          &Of::rigid,         &Of::implicit};
    }
    bool operator==(const OfBodyTables&) const = default;
};

/// The columns of each table in which a body has rows. The tables are in the order of OfBodyTables::members().
std::vector<std::vector<AnyColumn>> columns_by_body_table(Model& model);

OfBodyTables<Range> rows_of_body(const Model& model, std::size_t body);

struct RowMoves {
    OfBodyTables<std::vector<Range>> removed;  // removed rows of each table, ascending
    // for each old body row: number of rows by which the body's rows in each table move towards the start
    std::vector<OfBodyTables<Index>> shift_to_start;
    std::vector<Index> body_now;             // for each old body row: its new row; no_index: removed
    std::vector<Range> removed_colliders;    // ascending
    std::vector<Index> collider_now;         // for each old collider row: its new row; no_index: removed
    std::vector<Range> removed_attachments;  // rows of the attachments of removed bodies
    std::vector<Index> attachment_now;       // for each old attachment row: its new row; no_index: removed

    bool any() const { return !removed.bodies.empty() || !removed_colliders.empty(); }
};

/// Plans the removal of the rows with a nonzero mark. `bodies`, `colliders`: marks by row; rows beyond the last mark
/// are kept.
RowMoves row_moves(const Model& model, std::span<const std::uint8_t> bodies, std::span<const std::uint8_t> colliders);

}  // namespace skerry
