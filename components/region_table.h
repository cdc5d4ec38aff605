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

/// What a region was spared; or'ed.
enum RegionShortcut : std::uint8_t {
    shortcut_none = 0,
    shortcut_closed_form = 1,   // one contact
    shortcut_separating = 2,    // no contact closes: zero impulses solve it
    shortcut_certified = 4,     // the warm start solves it
    shortcut_frictionless = 8,  // one row a contact
    shortcut_in_lanes = 16      // small: solved side by side with others
};

/// One row per region, numbered by its first contact.
struct RegionTable {
    Ragged<Index> contacts;    // rows of ContactTable, ascending
    Ragged<Index> joints;      // rows of JointBlockTable, ascending; no rows where there is no joint
    Column<ContactKey> id;     // key of its first contact: a region that keeps it is the same region in the next step
    Column<Index> iterations;  // sweeps; 0 when the warm start already solves it
    Column<Real> error;        // e_nat, docs/methods/errors.md 2
    Column<RegionStatus> status;
    Column<RegionShortcut> shortcut;
    Column<Real> dissipated;  // J, taken out by its contacts in this step
    Column<Real> push_work;   // J, put in by moving positions alone
    // in which they are started: large ones by predicted cost, small ones by size, single contacts last
    Column<Index> order;
    bool pushed = false;  // some region wrote NodeTable::push_out

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

/// What is remembered of regions from step to step, by ascending id. It tells how long a region will take, and nothing
/// else: no result depends on it, so it is no part of the state.
struct RegionHistoryTable {
    Column<ContactKey> id;
    Column<Index> contacts;  // how many
    Column<Real> sweeps;     // moving average
    Column<Index> age;       // steps since the number of its contacts changed

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
