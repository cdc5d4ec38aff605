// Contacts between bodies that are asleep. Steps do not search for them.
#pragma once

#include "components/contact_table.h"

namespace skerry {

/// Contacts as they were in the last step that searched for them, in key order. When a body wakes, their impulses are
/// the warm start. The columns other than key, normal and impulse are kept only for display.
struct RestingContactTable {
    ContactTable contact;  // `region`: no_index
    Column<Real> step;     // time for which forces acted in the step that computed the impulse [s]

    void for_each_column(auto&& visit) {
        contact.for_each_column([&](const char* name, auto& column, ColumnRole) {
            const void* const place = &column;
            const bool starts = place == &contact.key || place == &contact.normal || place == &contact.impulse;
            visit(name, column, starts ? ColumnRole::state : ColumnRole::memory);
        });
        visit("step", step, ColumnRole::state);
    }
    std::size_t size() const { return step.size(); }
    bool empty() const { return step.empty(); }
};

}  // namespace skerry
