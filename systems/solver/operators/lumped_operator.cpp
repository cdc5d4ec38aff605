#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

template class RegionOperatorBase<LumpedOperator, InOrder, LumpedMemory>;
template class LumpedOperatorBy<InOrder>;

}  // namespace skerry
