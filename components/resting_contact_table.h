// Contacts of sleeping bodies with objects that do not move. Steps do not search for them.
#pragma once

#include "components/contact_table.h"

namespace skerry {

/// Contacts between a sleeping body and another sleeping body or a collider at rest, as last found, in key order. When
/// a body wakes, the stored impulses are the warm start of these contacts. All columns of `contact` other than key,
/// normal and impulse are stored only for display.
struct RestingContactTable {
    ContactTable contact;  // the column `region` is no_index
    Column<Real> step;     // time for which forces acted in the step that computed `impulse` [s]

    void for_each_column(auto&& visit) {
        contact.for_each_column([&](const char* name, auto& column, ColumnRole) {
            const void* const address = &column;
            const bool starts = address == &contact.key || address == &contact.normal || address == &contact.impulse;
            visit(name, column, starts ? ColumnRole::state : ColumnRole::memory);
        });
        visit("step", step, ColumnRole::state);
    }
    std::size_t size() const { return step.size(); }
    bool empty() const { return step.empty(); }
};

}  // namespace skerry
