// What dense Newton steps work with (systems/solver/methods/newton.h). It stands with the operators since they keep it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Working memory of the method; grows to the largest region seen.
struct NewtonMemory {
    Eigen::MatrixXd operator_matrix;  // W
    Eigen::MatrixXd jacobian;         // of the active contacts
    Eigen::VectorXd rest, change;
    std::vector<Index> active;  // contacts that are not open

    /// Leaves the solution of jacobian x = rest in `rest`, the factors in `jacobian`. Out of line: one factorisation is
    /// as long to compile as all methods of one operator.
    void solve_equations();
};

}  // namespace skerry
