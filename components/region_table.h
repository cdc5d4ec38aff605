// Contact regions of this step: independent frictional contact problems.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Result of the solver for a region. `certified`: zero impulses or the warm start solved the problem, so the solver
/// made no sweeps.
enum class RegionStatus : std::uint8_t { converged, certified, iteration_limit, not_finite };

/// Shortcuts that the solver used for a region; several shortcuts are combined with bitwise or.
enum RegionShortcut : std::uint8_t {
    shortcut_none = 0,
    shortcut_closed_form = 1,   // the exact solution of a single contact was used
    shortcut_separating = 2,    // no contact closes, so all impulses are zero
    shortcut_certified = 4,     // the warm start is the solution
    shortcut_frictionless = 8,  // the contacts have no friction: one equation per contact
    // the region is small and was solved together with other regions, one region per vector lane
    shortcut_in_lanes = 16
};

/// One row per region. Regions are sorted by the row of their first contact.
struct RegionTable {
    Ragged<Index> contacts;  // rows of ContactTable, ascending
    Ragged<Index> joints;    // rows of JointBlockTable, ascending; `joints` has no rows if there are no joints
    Ragged<Index> cables;    // indices in CableBlockTable::solved(), ascending; no rows if there are no such cables
    // Key that identifies the region across steps: the key of its first contact. For a region without contacts,
    // recall_regions makes a key.
    Column<ContactKey> id;
    Column<Index> iterations;  // number of solver sweeps; 0 if a shortcut made sweeps unnecessary
    Column<Real> error;        // relative error e_nat of the solution (docs/methods/errors.md 2)
    Column<RegionStatus> status;
    Column<RegionShortcut> shortcut;
    Column<Real> dissipated;  // energy dissipated by the contacts of the region in this step [J]
    Column<Real> push_work;   // energy that the displacements by NodeTable::push_out add [J]
    // Rows of the regions in the order in which the solver starts them. Large regions come first, by descending
    // predicted cost, so that no long task starts late. Small regions follow by descending size, single contacts last.
    Column<Index> order;
    bool pushed = false;  // true: some region has written NodeTable::push_out

    std::size_t size() const { return contacts.size(); }
    std::span<const Index> joints_of(std::size_t region) const {
        return joints.size() == 0 ? std::span<const Index>() : joints[region];
    }
    std::span<const Index> cables_of(std::size_t region) const {
        return cables.size() == 0 ? std::span<const Index>() : cables[region];
    }
    void for_each_column(auto&& visit) {
        visit("contacts.offset", contacts.offset, ColumnRole::scratch);
        visit("contacts.item", contacts.item, ColumnRole::scratch);
        visit("joints.offset", joints.offset, ColumnRole::scratch);
        visit("joints.item", joints.item, ColumnRole::scratch);
        visit("cables.offset", cables.offset, ColumnRole::scratch);
        visit("cables.item", cables.item, ColumnRole::scratch);
        visit("id", id, ColumnRole::scratch);
        visit("iterations", iterations, ColumnRole::scratch);
        visit("error", error, ColumnRole::scratch);
        visit("status", status, ColumnRole::scratch);
        visit("shortcut", shortcut, ColumnRole::scratch);
        visit("dissipated", dissipated, ColumnRole::scratch);
        visit("push_work", push_work, ColumnRole::scratch);
        visit("order", order, ColumnRole::scratch);
    }
};

/// One row per region of the last step, in ascending order of id: statistics that predict the solution time of the
/// region. No result depends on this table, so it is not part of the state.
struct RegionHistoryTable {
    Column<ContactKey> id;
    Column<Index> contacts;  // number of contacts
    Column<Real> sweeps;     // moving average of the number of solver sweeps
    Column<Index> age;       // number of steps since the number of contacts changed

    void for_each_column(auto&& visit) {
        visit("id", id, ColumnRole::scratch);
        visit("contacts", contacts, ColumnRole::scratch);
        visit("sweeps", sweeps, ColumnRole::scratch);
        visit("age", age, ColumnRole::scratch);
    }
    std::size_t size() const { return id.size(); }
    void resize(std::size_t count) {
        for_each_column([count](const char*, auto& column, ColumnRole) { column.resize(count); });
    }
};

}  // namespace skerry
