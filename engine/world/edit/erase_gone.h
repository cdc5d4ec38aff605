// Removes the rows of erased bodies and colliders from all tables. Each later row is moved and renumbered once, however
// many rows are removed.
#pragma once

#include "components/contact_table.h"
#include "engine/world/edit/row_moves.h"
#include "engine/world/state/contact_cache.h"

namespace skerry {

// erase_from_cache.cpp

/// Removes pairs with an erased object and contacts of sleeping bodies with an erased object. Other pairs keep their
/// data. Warm-start impulses stay, since their keys name bodies by slot. `body_of_node`: body row of each node before
/// the removal.
void erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactCache& cache);
/// Removes the contacts of a step that touch an erased object. Returns the removed rows.
std::vector<Range> erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactTable& contacts);

// erase_gone.cpp

/// Removes the rows of erased bodies and colliders from the model. Element patches from the first erased body on are
/// removed too; Model::extend_derived builds them again.
void erase_gone(const RowMoves& moves, Model& model);
/// Removes rows of scripted colliders or attachments together with their keyframes. `gone` is in ascending order.
void erase_scripted_rows(std::span<const Range> gone, ColliderTable& table);
void erase_scripted_rows(std::span<const Range> gone, AttachmentTable& table);

}  // namespace skerry
