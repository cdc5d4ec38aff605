// What a world tells about itself.
#pragma once

#include "engine/world/state/model.h"

namespace skerry {

/// `dissipated`: J, over the run.
Energy energy_of(const Model& model, Real dissipated);

}  // namespace skerry
