// Fibres in bodies: one row per family of fibres, and the tetrahedra through which they run
// (docs/methods/elasticity.md 2.7).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/column_role.h"
#include "components/key_lists.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Stress vectors of the fibres of a tetrahedron in a step: first Piola-Kirchhoff stress times the direction of the
/// fibres in the rest shape [Pa].
struct FibrePull {
    Vec3 passive = Vec3::Zero();  // stress due to the stretch of the fibres
    Vec3 whole = Vec3::Zero();    // `passive` plus the stress due to the active tension
};

/// One row per family of fibres.
struct FibreTable {
    Column<std::uint32_t> slot;
    Column<Index> body;          // row of BodyTable
    Column<Real> stiffness;      // k_1 [Pa]
    Column<Real> exponent;       // k_2
    Column<Range> tetrahedra;    // rows of the columns by tetrahedron
    Column<Range> tension_keys;  // rows of `key`, at least one
    // The following columns have one row per tetrahedron.
    Column<Index> tetrahedron;          // number in the mesh of the body
    Column<std::array<Index, 4>> node;  // numbers in the mesh of the body
    Column<std::array<Real, 4>> slope;  // derivatives of the nodes' shape functions along the fibres [1/m]
    Column<Real> volume;                // at rest [m^3]
    Column<Vec3> passive;               // FibrePull::passive of the last step; only the energy balance uses it [Pa]
    // Upper bound of omega^2/E, by which the fibres limit the stable step. E is the modulus along the fibres, and omega
    // the highest circular frequency of the tetrahedron due to the fibres alone. Written by weigh_fibres [1/(Pa s^2)].
    Column<Real> mobility;
    Column<FibrePull> next;  // written by add_fibre_forces
    Column<TimeKey> key;     // active tensions of all families [Pa]

    std::size_t size() const { return slot.size(); }

    std::span<const TimeKey> keys_of(std::size_t row) const { return rows_of(key.span(), tension_keys[row]); }
    /// Erases the keys and the tetrahedra of a row.
    void erase_keys_of(std::size_t row) {
        erase_keys(tension_keys, key, row);
        erase_lists(tetrahedra, row, tetrahedron, node, slope, volume, passive, mobility, next);
    }

    /// Visits the columns with one row per family.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("body", body, ColumnRole::body);
        visit("stiffness", stiffness, ColumnRole::state);
        visit("exponent", exponent, ColumnRole::state);
        visit("tetrahedra", tetrahedra, ColumnRole::link);
        visit("tension_keys", tension_keys, ColumnRole::link);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("tetrahedron", tetrahedron, ColumnRole::state);
        visit("node", node, ColumnRole::state);
        visit("slope", slope, ColumnRole::state);
        visit("volume", volume, ColumnRole::state);
        visit("passive", passive, ColumnRole::memory);
        visit("mobility", mobility, ColumnRole::derived);
        visit("next", next, ColumnRole::scratch);
        visit("key", key, ColumnRole::state);
    }
};

}  // namespace skerry
