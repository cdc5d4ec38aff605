#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

template class LumpedOperatorBy<InOrder>;

}  // namespace skerry
