// Rows of bodies and colliders that are gone are taken out of all tables at once: each row behind the first of them is
// moved and renumbered once, however many there are.
#pragma once

#include "components/contact_table.h"
#include "engine/world/edit/row_moves.h"
#include "engine/world/state/contact_cache.h"

namespace skerry {

// erase_from_cache.cpp
/// Pairs of what is gone go, and their contacts at rest; others keep what is known of them. Impulses to start from
/// stay, since their keys name bodies by slot. `body_of_node` as it was before.
void erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactCache& cache);
/// Contacts of a step. Returns the rows that went.
std::vector<Range> erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactTable& contacts);

// erase_gone.cpp
/// Patches of the bodies behind the first that is gone are left to Model::extend_derived.
void erase_gone(const RowMoves& moves, Model& model);
/// Rows of a table of what moves by scripts, with their keys; ascending.
void erase_scripted_rows(std::span<const Range> gone, ColliderTable& table);
void erase_scripted_rows(std::span<const Range> gone, AttachmentTable& table);

}  // namespace skerry
