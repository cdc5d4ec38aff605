#include "systems/solver/coloured/by_colour.h"

namespace skerry {

template class RegionOperatorBase<ColouredOperator, ByColour, LumpedMemory>;
template class LumpedOperatorBy<ByColour>;

}  // namespace skerry
