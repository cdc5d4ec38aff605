// The role of a column in the state of a world.
#pragma once

#include <cstdint>

namespace skerry {

/// Every column has one of these roles. `state`, `link` and `body` are hashed and saved, `memory` is saved only;
/// `derived` and `scratch` are neither.
enum class ColumnRole : std::uint8_t {
    state,    // the next step depends on it, and it cannot be derived
    link,     // state that refers to other tables, such as a row index: hashed by its meaning
    body,     // link to rows of BodyTable, or no_index: tables of Model::for_each_joining, handled by one piece of code
    memory,   // bounds and their reference values: they decide when something is checked again, but change no result
    derived,  // computed from the state by the function that its table names
    scratch,  // written by each step before it is read, or no result depends on it
};

inline constexpr bool is_state(ColumnRole role) {
    return role == ColumnRole::state || role == ColumnRole::link || role == ColumnRole::body;
}

inline constexpr bool is_saved(ColumnRole role) {
    return is_state(role) || role == ColumnRole::memory;
}

}  // namespace skerry
