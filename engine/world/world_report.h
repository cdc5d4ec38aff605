// Energies of a world, for its reports.
#pragma once

#include "engine/world/state/model.h"

namespace skerry {

/// Returns the energies of a world. `time`: present time [s]. `dissipated`: energy dissipated in the run so far [J].
Energy energy_of(const Model& model, Real time, Real dissipated);

}  // namespace skerry
