// Contacts between what rests, which no step looks for.
#pragma once

#include "components/contact_table.h"

namespace skerry {

/// Contacts as they were in the last step that looked for them, in key order. Of them steps need the impulses, to start
/// from when something wakes; the others are kept to be shown.
struct RestingContactTable {
    ContactTable contact;  // `region`: no_index
    Column<Real> step;     // s, for which forces acted in the step that its impulse belongs to

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
