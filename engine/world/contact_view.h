// Contacts in the form that users see: with handles, and with node numbers local to their bodies.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

/// Fills the view of the last step's contacts, unless it is up to date.
void view_contacts(WorldState& world);

}  // namespace skerry
