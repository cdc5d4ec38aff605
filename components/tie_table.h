// Ties: nodes of a deformable body that are fixed to points on another object (docs/methods/ties.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/tie_kind.h"
#include "components/types.h"

namespace skerry {

/// One row per tie. Each row has a range of rows in the columns of tied nodes.
struct TieTable {
    Column<std::uint32_t> slot;
    Column<TieKind> kind;
    Column<std::uint8_t> parts;                    // 1: the tie switches off collisions between its two objects
    Column<std::uint8_t> close_gap, bodies_touch;  // settings of the user (TieSettings)
    Column<Index> first;                           // row of BodyTable; the deformable body whose nodes are tied
    Column<Index> second;                          // row of BodyTable, or no_index
    Column<Index> collider;      // row of ColliderTable, or no_index; without body and collider: the world
    Column<Range> nodes;         // range of rows of the columns `node` to `broken`
    Column<Real> break_force;    // force at which a node breaks off; may be infinite [N]
    Column<Real> largest_force;  // largest total force of the tie in a step so far [N]
    Column<Real> step;           // time for which the forces of the tie acted in the last step; 0 before the first [s]

    // The next columns have one row per tied node. Nodes have their numbers in the meshes of the bodies.
    Column<Index> node;  // node of the first body
    // Triangle of the second body, and weights of its corners. Used only if the second body deforms.
    Column<std::array<Index, 3>> corner;
    Column<Vec3> weight;
    // Position of the node relative to the other object [m], by kind of object:
    // - explicit body: relative to the point on the triangle, in the frame of the triangle
    // - implicit body: relative to the point on the triangle, in the frame of the mesh
    // - rigid body, collider, world: in the frame of the mesh, of the collider, or of the world
    Column<Vec3> place;
    // Unit normal of the other object, in the frame of `place`. If the other object deforms, the normal of the triangle
    // is used instead.
    Column<Vec3> normal;
    Column<Vec3> impulse;  // impulse on the node in the last step [N s]
    Column<Real> broken;   // time at which the node broke off; infinite if it is tied [s]

    std::size_t size() const { return slot.size(); }
    /// True if at least one node of the tie has not broken off.
    bool holds(std::size_t tie) const {
        for (Index k = nodes[tie].begin; k < nodes[tie].end; ++k)
            if (!(broken[static_cast<std::size_t>(k)] < infinity)) return true;
        return false;
    }

    void erase_keys_of(std::size_t tie);

    /// Visits the columns with one row per tie.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("parts", parts, ColumnRole::state);
        visit("close_gap", close_gap, ColumnRole::state);
        visit("bodies_touch", bodies_touch, ColumnRole::state);
        visit("first", first, ColumnRole::body);
        visit("second", second, ColumnRole::body);
        visit("collider", collider, ColumnRole::collider);
        visit("nodes", nodes, ColumnRole::link);
        visit("break_force", break_force, ColumnRole::state);
        visit("largest_force", largest_force, ColumnRole::state);
        visit("step", step, ColumnRole::state);
    }
    /// Visits the columns with one row per tied node.
    void for_each_node_column(auto&& visit) {
        visit("node", node, ColumnRole::state);
        visit("corner", corner, ColumnRole::state);
        visit("weight", weight, ColumnRole::state);
        visit("place", place, ColumnRole::state);
        visit("normal", normal, ColumnRole::state);
        visit("impulse", impulse, ColumnRole::state);
        visit("broken", broken, ColumnRole::state);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        for_each_node_column(visit);
    }
};

/// Removes the tied nodes of a tie.
inline void TieTable::erase_keys_of(std::size_t tie) {
    const Range erased = nodes[tie];
    for_each_node_column([&](const char*, auto& column, ColumnRole) {
        column.erase(static_cast<std::size_t>(erased.begin), static_cast<std::size_t>(erased.size()));
    });
    nodes[tie] = {};
    for (Range& other : nodes)
        if (other.begin > erased.begin) other = {other.begin - erased.size(), other.end - erased.size()};
}

/// One row per tied node that takes part in the contact problem of a step. While regions are solved, ContactTable
/// contains these rows after those of the contacts.
struct TieRowTable {
    Column<Index> tie;   // row of TieTable
    Column<Index> node;  // index of the tied node in the columns `node` to `broken` of TieTable
    Column<Stencil> stencil;
    Column<Vec3> point;    // position of the tied node at the start of the step [m]
    Column<Vec3> impulse;  // impulse on the node; before the solve: the warm start [N s]
    // One row per tie: 1 if its bodies are asleep. The tie then keeps its last impulses.
    Column<std::uint8_t> rests;

    std::size_t size() const { return tie.size(); }
    void for_each_column(auto&& visit) {
        visit("tie", tie, ColumnRole::scratch);
        visit("node", node, ColumnRole::scratch);
        visit("stencil", stencil, ColumnRole::scratch);
        visit("point", point, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("rests", rests, ColumnRole::scratch);
    }
};

}  // namespace skerry
