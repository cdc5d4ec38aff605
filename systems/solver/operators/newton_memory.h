// Memory of dense Newton steps (systems/solver/methods/newton.cpp). The file is in this folder because operators own
// the memory.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Working memory of the Newton method. It grows to the size of the largest region seen.
struct NewtonMemory {
    struct Contact {
        Vec4 normal;
        Real mobility;
        FrictionLimits mu;
    };

    Eigen::MatrixXd operator_matrix;  // W
    Eigen::MatrixXd jacobian;         // Jacobian of the natural map of the active contacts
    Eigen::VectorXd rest, change;
    std::vector<Contact> contact;
    std::vector<Index> active;  // numbers of the contacts that are not open
};

}  // namespace skerry
