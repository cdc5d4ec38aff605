// Contacts as a user sees them: with handles, and numbers of nodes within their bodies.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

/// Fills the view of the last step's contacts, unless it has been.
void view_contacts(WorldState& world);

}  // namespace skerry
