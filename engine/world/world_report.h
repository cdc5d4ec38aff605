// Reports of a world about its own state.
#pragma once

#include "engine/world/state/model.h"

namespace skerry {

/// Returns the present energies of a world. `dissipated`: energy dissipated over the run [J].
Energy energy_of(const Model& model, Real dissipated);

}  // namespace skerry
