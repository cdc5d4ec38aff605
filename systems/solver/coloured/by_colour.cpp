#include "systems/solver/coloured/by_colour.h"

namespace skerry {

template class LumpedOperatorBy<ByColour>;

}  // namespace skerry
