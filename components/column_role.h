// Roles of columns: they decide which columns are hashed and which are saved.
#pragma once

#include <cstdint>

namespace skerry {

/// Role of a column. Columns with the roles `state`, `link`, `body` and `collider` are hashed and saved. Columns with
/// the role `memory` are saved but not hashed. `derived` and `scratch` columns are neither hashed nor saved.
enum class ColumnRole : std::uint8_t {
    state,  // the next step depends on the column, and the column cannot be derived from other columns
    // state that is not hashed as stored: state_hash.cpp hashes, for example, a handle slot instead of a row index
    link,
    // like `link`: row of BodyTable, or no_index; only in tables of objects that join bodies (Model::for_each_joining)
    body,
    // like `link`: row of ColliderTable, or no_index; only in tables that Model::for_each_joining visits
    collider,
    // no result of a step depends on the column; most such columns are bounds that tell when a check must be repeated,
    // for example a collision search
    memory,
    derived,  // computed from the state; the comment of the table names the function that does it
    scratch,  // values that each step writes before reading them, or that affect no result
};

inline constexpr bool is_state(ColumnRole role) {
    return role == ColumnRole::state || role == ColumnRole::link || role == ColumnRole::body ||
           role == ColumnRole::collider;
}

inline constexpr bool is_saved(ColumnRole role) {
    return is_state(role) || role == ColumnRole::memory;
}

}  // namespace skerry
