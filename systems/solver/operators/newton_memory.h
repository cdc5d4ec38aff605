// Memory of dense Newton steps (systems/solver/methods/newton.cpp). It is in this folder because operators own it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Working memory of the method; grows to the largest region seen.
struct NewtonMemory {
    struct Contact {
        Vec4 normal;
        Real mobility, mu;
    };

    Eigen::MatrixXd operator_matrix;  // W
    Eigen::MatrixXd jacobian;         // matrix for the active contacts
    Eigen::VectorXd rest, change;
    std::vector<Contact> contact;
    std::vector<Index> active;  // contacts that are not open
};

}  // namespace skerry
