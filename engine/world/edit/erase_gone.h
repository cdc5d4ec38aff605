// Removes the rows of erased bodies and colliders from all tables at once. Each row after the first of them is moved
// and renumbered once, however many are gone.
#pragma once

#include "components/contact_table.h"
#include "engine/world/edit/row_moves.h"
#include "engine/world/state/contact_cache.h"

namespace skerry {

// erase_from_cache.cpp
/// Removes pairs with erased partners and their contacts at rest; other pairs keep their data. Impulses of the warm
/// start stay, since their keys name bodies by slot. `body_of_node`: from before the removal.
void erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactCache& cache);
/// Removes contacts of a step. Returns the rows removed.
std::vector<Range> erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactTable& contacts);

// erase_gone.cpp
/// Patches of the bodies after the first erased one are left to Model::extend_derived.
void erase_gone(const RowMoves& moves, Model& model);
/// Removes rows of scripted colliders or attachments with their keyframes. `gone` is ascending.
void erase_scripted_rows(std::span<const Range> gone, ColliderTable& table);
void erase_scripted_rows(std::span<const Range> gone, AttachmentTable& table);

}  // namespace skerry
