// Marks of ghosts, which are copies of bodies that another rank (process) owns. Sums over bodies leave out ghosts,
// because the owner counts the body.
#pragma once

#include <span>

#include "components/body_table.h"

namespace skerry {

/// Shows which bodies are ghosts. If the span is empty, the world is not divided among ranks.
struct GhostMarks {
    std::span<const GhostKind> body_ghost = {};  // column BodyTable::ghost

    bool contain(Index body) const {
        return !body_ghost.empty() && body != no_index && body_ghost[body] != GhostKind::none;
    }
};

}  // namespace skerry
