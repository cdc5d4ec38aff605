// Contact regions of this step: independent frictional contact problems.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

enum class RegionStatus : std::uint8_t { converged, certified, iteration_limit, not_finite };

/// Shortcuts taken by the solver for a region; combined with bitwise or.
enum RegionShortcut : std::uint8_t {
    shortcut_none = 0,
    shortcut_closed_form = 1,   // exact solution of a single contact
    shortcut_separating = 2,    // no contact closes, so zero impulses are the solution
    shortcut_certified = 4,     // the warm start is the solution
    shortcut_frictionless = 8,  // no friction: one equation per contact
    shortcut_in_lanes = 16      // small region: solved side by side with other regions
};

/// One row per region, in the order of first contacts.
struct RegionTable {
    Ragged<Index> contacts;    // rows of ContactTable, ascending
    Ragged<Index> joints;      // rows of JointBlockTable, ascending; without joints the list has no rows
    Column<ContactKey> id;     // key of the first contact; identifies the region across steps
    Column<Index> iterations;  // number of sweeps; 0 if the warm start is the solution
    Column<Real> error;        // e_nat, docs/methods/errors.md 2
    Column<RegionStatus> status;
    Column<RegionShortcut> shortcut;
    Column<Real> dissipated;  // energy dissipated by the contacts of the region in this step [J]
    Column<Real> push_work;   // energy added by push_out, which moves positions only [J]
    // Order in which the solver starts the regions: large regions by predicted cost, small ones by size, single
    // contacts last.
    Column<Index> order;
    bool pushed = false;  // true: some region has written NodeTable::push_out

    std::size_t size() const { return contacts.size(); }
    std::span<const Index> joints_of(std::size_t region) const {
        return joints.size() == 0 ? std::span<const Index>() : joints[region];
    }
    void for_each_column(auto&& visit) {
        visit("contacts.offset", contacts.offset, ColumnRole::scratch);
        visit("contacts.item", contacts.item, ColumnRole::scratch);
        visit("joints.offset", joints.offset, ColumnRole::scratch);
        visit("joints.item", joints.item, ColumnRole::scratch);
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

/// History of the regions across steps, by ascending id. It serves only to predict how long a region will take. No
/// result depends on it, so it is not part of the state.
struct RegionHistoryTable {
    Column<ContactKey> id;
    Column<Index> contacts;  // number of contacts
    Column<Real> sweeps;     // moving average of the number of sweeps
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
