// Which rows go when bodies and colliders do, and where the others go: one look at the tables before any of them
// changes, however many are gone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// Something of each table in which a body has rows.
template <class T>
struct OfBodyTables {
    T bodies{}, nodes{}, node_blocks{}, blocks{}, element_nodes{}, tetrahedron_blocks{}, triangles{}, edges{},
        vertices{}, vertex_triangles{}, bvh_nodes{}, bvh_leaves{}, rigid{}, implicit{};

    /// The only list of them.
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
    std::vector<OfBodyTables<Index>> down;  // by body that there was: how far its rows move
    std::vector<Index> body_now;            // by row that there was; no_index: gone
    std::vector<Range> colliders_gone;      // ascending
    std::vector<Index> collider_now;        // by row that there was; no_index: gone
    std::vector<Range> attachments_gone;    // those of the bodies
    std::vector<Index> attachment_now;      // by row that there was; no_index: gone

    bool any() const { return !gone.bodies.empty() || !colliders_gone.empty(); }
};

/// `bodies` and `colliders`: by row, those that are not zero go. Rows beyond their ends stay.
RowMoves row_moves(const Model& model, std::span<const std::uint8_t> bodies, std::span<const std::uint8_t> colliders);

}  // namespace skerry
