// Contacts in the form that users see: objects as handles, and node numbers local to each body.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

/// Fills RunRecord::contact_view with the contacts of the last step, unless it is already up to date.
void view_contacts(WorldState& world);

}  // namespace skerry
