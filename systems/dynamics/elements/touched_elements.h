// Elements beside contacts: with multirate they get an impulse in every step (docs/methods/stable_step.md 7.5).
#pragma once

#include <cstdint>
#include <span>

#include "components/element_table.h"
#include "components/range.h"
#include "components/step_levels.h"

namespace skerry {

/// touched[block] of some blocks = whether a node of theirs is touched. Sequential.
void find_touched_blocks(const ElementNodeTable& nodes, std::span<const std::uint8_t> node_touched, Range blocks,
                         ElementBlockTable& elements);

/// Lets the patches and the nodes of a body know which of its blocks are touched. Returns whether any is. Sequential.
bool mark_touched(const ElementBlockTable& elements, const ElementNodeTable& element_nodes, Range blocks, Range nodes,
                  ElementPatches& patches, std::span<LevelMask> node_levels);

}  // namespace skerry
