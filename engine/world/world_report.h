// Reports of a world about its own state.
#pragma once

#include "engine/world/state/model.h"

namespace skerry {

/// Returns the energies of a world at the present time `time` [s]. `dissipated`: energy dissipated over the run [J].
Energy energy_of(const Model& model, Real time, Real dissipated);

}  // namespace skerry
