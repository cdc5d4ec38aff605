// The role of a column in the state of a world.
#pragma once

#include <cstdint>

namespace skerry {

/// Role of a column. Columns with the roles `state`, `link`, `body` and `collider` are hashed and saved. Columns with
/// the role `memory` are saved but not hashed. `derived` and `scratch` columns are neither hashed nor saved.
enum class ColumnRole : std::uint8_t {
    state,  // the next step depends on the column, and the column cannot be derived from other columns
    // state that is not hashed as stored: state_hash.cpp hashes, for example, a handle slot instead of a row index
    link,
    body,      // `link` to a row of BodyTable, or no_index; only in tables that Model::for_each_joining visits
    collider,  // `link` to a row of ColliderTable, or no_index; only in tables that Model::for_each_joining visits
    memory,    // no result depends on the column; most such columns are bounds that decide when a check is repeated
    derived,   // computed from the state by the function that the comment of the table names
    scratch,   // values that each step writes before reading them, or that affect no result
};

inline constexpr bool is_state(ColumnRole role) {
    return role == ColumnRole::state || role == ColumnRole::link || role == ColumnRole::body ||
           role == ColumnRole::collider;
}

inline constexpr bool is_saved(ColumnRole role) {
    return is_state(role) || role == ColumnRole::memory;
}

}  // namespace skerry
