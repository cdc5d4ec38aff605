// Loads and force fields: one row per load.
#pragma once

#include <array>
#include <span>

#include "components/column.h"
#include "components/column_role.h"
#include "components/key_lists.h"
#include "components/load_kind.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// One row per load. A force, or a traction on the rest area, exerts on a node the force scale * weight * vector. The
/// scale may change over time (`scale_keys`). For all other loads see docs/methods/loads.md 1.
struct LoadTable {
    Column<std::uint32_t> slot;
    Column<LoadKind> kind;
    Column<Index> body;     // row of BodyTable; no_index for a field that acts on all bodies
    Column<Vec3> vector;    // force [N], traction [Pa], acceleration [m/s^2] or wind velocity [m/s]; unused for gravity
    Column<Real> rate;      // rate of a drag [1/s]
    Column<LoadArea> area;  // area on which a traction acts
    Column<Range> nodes;    // range of rows in the columns `node` and `weight`; empty for fields
    Column<Range> faces;    // range of rows in the column `face`; empty except for tractions
    Column<Range> scale_keys;  // range of rows in the column `key`; never empty
    // Nodes of all forces and tractions, as numbers in the meshes of their bodies. The weight of a node depends on the
    // load:
    // - force: fraction of the force that acts on the node
    // - traction on the rest area: area that belongs to the node [m^2]
    // - traction on the present area, which lists the three nodes of each face in turn: number of loaded faces at the
    //   node; it serves only to bound the stable step
    Column<Index> node;
    Column<Real> weight;
    Column<std::array<Index, 3>> face;  // faces of all tractions: node numbers in the meshes of their bodies
    Column<TimeKey> key;                // scales of all loads over time

    std::size_t size() const { return slot.size(); }

    std::span<const TimeKey> keys_of(std::size_t load) const { return rows_of(key.span(), scale_keys[load]); }
    std::span<const Index> nodes_of(std::size_t load) const { return rows_of(node.span(), nodes[load]); }
    std::span<const Real> weights_of(std::size_t load) const { return rows_of(weight.span(), nodes[load]); }
    /// Erases the lists of one row.
    void erase_keys_of(std::size_t load) {
        erase_keys(scale_keys, key, load);
        erase_lists(nodes, load, node, weight);
        erase_lists(faces, load, face);
    }

    /// Visits the columns with one row per load. The columns of lists are visited by for_each_column only.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("body", body, ColumnRole::body);
        visit("vector", vector, ColumnRole::state);
        visit("rate", rate, ColumnRole::state);
        visit("area", area, ColumnRole::state);
        visit("nodes", nodes, ColumnRole::link);
        visit("faces", faces, ColumnRole::link);
        visit("scale_keys", scale_keys, ColumnRole::link);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("node", node, ColumnRole::state);
        visit("weight", weight, ColumnRole::state);
        visit("face", face, ColumnRole::state);
        visit("key", key, ColumnRole::state);
    }
};

}  // namespace skerry
