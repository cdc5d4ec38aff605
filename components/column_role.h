// The role of a column in the state of a world.
#pragma once

#include <cstdint>

namespace skerry {

/// Role of a column. Columns with the roles `state`, `link` and `body` are hashed and saved, `memory` is only saved;
/// `derived` and `scratch` are neither hashed nor saved.
enum class ColumnRole : std::uint8_t {
    state,    // the next step depends on the column, and it cannot be derived
    link,     // state that refers to other tables, such as a row index; its meaning is hashed, not its value
    body,     // link to a row of BodyTable, or no_index; only in tables of Model::for_each_joining
    memory,   // bounds and their reference values: they decide when a check is repeated, but change no result
    derived,  // computed from the state by the function that the comment of the table names
    scratch,  // written by each step before it is read, or irrelevant to all results
};

inline constexpr bool is_state(ColumnRole role) {
    return role == ColumnRole::state || role == ColumnRole::link || role == ColumnRole::body;
}

inline constexpr bool is_saved(ColumnRole role) {
    return is_state(role) || role == ColumnRole::memory;
}

}  // namespace skerry
