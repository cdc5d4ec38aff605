// What a column of a table is to the next step.
#pragma once

#include <cstdint>

namespace skerry {

/// Every column is one of these. `state` and `link` are hashed and saved, `memory` is saved; the others are neither.
enum class ColumnRole : std::uint8_t {
    state,    // the next step depends on it, and nothing else says it
    link,     // state that means something only with other tables, such as a row: hashed by that meaning
    memory,   // no result depends on it, only when something is looked at again: bounds, and where they count from
    derived,  // made from state, by the function that its table names
    scratch,  // written by each step before it is read, or no result depends on it
};

inline constexpr bool is_state(ColumnRole role) {
    return role == ColumnRole::state || role == ColumnRole::link;
}

inline constexpr bool is_saved(ColumnRole role) {
    return is_state(role) || role == ColumnRole::memory;
}

}  // namespace skerry
