// Contacts in the form that users see: with handles of objects, and with node numbers within each body.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

/// Fills RunRecord::contact_view with the contacts of the last step and those between sleeping bodies, unless it is
/// already up to date.
void view_contacts(WorldState& world);

}  // namespace skerry
