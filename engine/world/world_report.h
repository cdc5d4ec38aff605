// Reports of a world about its own state.
#pragma once

#include "engine/world/state/model.h"

namespace skerry {

/// Present energies of a world. `dissipated`: energy dissipated over the run [J].
Energy energy_of(const Model& model, Real dissipated);

}  // namespace skerry
