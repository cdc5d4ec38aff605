// Rows removed with bodies and colliders, and the new places of all others. They are found in one pass over the tables
// before any table changes, however many rows are gone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// One value for each table in which a body has rows.
template <class T>
struct OfBodyTables {
    T bodies{}, nodes{}, node_blocks{}, blocks{}, element_nodes{}, tetrahedron_blocks{}, triangles{}, edges{},
        vertices{}, vertex_triangles{}, bvh_nodes{}, bvh_leaves{}, rigid{}, implicit{};

    /// The only list of these members.
    static constexpr auto members() {
        using Of = OfBodyTables;
        return std::array{&Of::bodies,        &Of::nodes,     &Of::node_blocks,        &Of::blocks,
                          &Of::element_nodes, &Of::edges,     &Of::tetrahedron_blocks, &Of::triangles,
                          &Of::vertices,      &Of::bvh_nodes, &Of::vertex_triangles,   &Of::bvh_leaves,
                          &Of::rigid,         &Of::implicit};
    }
};

OfBodyTables<Range> rows_of_body(const Model& model, std::size_t body);

struct RowMoves {
    OfBodyTables<std::vector<Range>> gone;  // ascending
    std::vector<OfBodyTables<Index>> down;  // by old row of the body: how far its rows move down
    std::vector<Index> body_now;            // by old row; no_index: gone
    std::vector<Range> colliders_gone;      // ascending
    std::vector<Index> collider_now;        // by old row; no_index: gone
    std::vector<Range> attachments_gone;    // attachments of the bodies that are gone
    std::vector<Index> attachment_now;      // by old row; no_index: gone

    bool any() const { return !gone.bodies.empty() || !colliders_gone.empty(); }
};

/// `bodies` and `colliders`: marks by row; rows with a nonzero mark are removed. Rows beyond their ends stay.
RowMoves row_moves(const Model& model, std::span<const std::uint8_t> bodies, std::span<const std::uint8_t> colliders);

}  // namespace skerry
