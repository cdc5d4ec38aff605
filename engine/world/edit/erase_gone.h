// Removes the rows of erased bodies and colliders from all tables. However many rows are removed together, each
// remaining row is moved and renumbered only once.
#pragma once

#include "components/contact_table.h"
#include "engine/world/edit/row_moves.h"
#include "engine/world/state/contact_cache.h"

namespace skerry {

// erase_from_cache.cpp

/// Removes pairs of an erased object, and contacts of sleeping bodies with an erased object. Other pairs keep their
/// data. Warm-start impulses need no change, since their keys name bodies by slot and not by row. `body_of_node`: body
/// row of each node before the removal.
void erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactCache& cache);
/// Removes those contacts of a step that belong to an erased object. Returns the removed rows.
std::vector<Range> erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactTable& contacts);

// erase_gone.cpp

/// Removes the rows of erased bodies and colliders from the model. Also removes the patches (groups of neighbouring
/// element blocks) of the first erased body and of all later bodies; Model::extend_derived builds these patches again.
void erase_gone(const RowMoves& moves, Model& model);
/// Renumbers all references between rows of one body, in all tables. `rows`: the present rows of the body. `shift`: for
/// each table, the number that is subtracted from each reference to a row of this table.
void renumber_rows_of_body(Model& model, std::size_t body, const OfBodyTables<Range>& rows,
                           const OfBodyTables<Index>& shift);
/// Removes scripted colliders or attachments together with their keyframes. `removed`: removed rows in ascending order.
void erase_scripted_rows(std::span<const Range> removed, ColliderTable& table);
void erase_scripted_rows(std::span<const Range> removed, AttachmentTable& table);

}  // namespace skerry
