#include "systems/solver/operators/newton_memory.h"

#include <Eigen/LU>

namespace skerry {

void NewtonMemory::solve_equations() {
    const Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> factors(jacobian);
    rest = factors.solve(rest);
}

}  // namespace skerry
