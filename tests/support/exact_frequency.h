// The exact stability limit of the step, from finite differences and a dense eigenvalue solver. Tests compare the bound
// of stable_step with it.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"

namespace skerry::test {

/// Largest eigenvalue of M^-1/2 K M^-1/2 of the whole mesh in its present shape. K comes from central differences of
/// the nodal forces.
inline Real exact_frequency_squared(ElasticBody& body) {
    const auto executor = make_executor(Backend::serial, 1);
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(body.position.size());
    Eigen::MatrixXd K(size, size);
    constexpr Real step = 1e-6;  // [m]; cells are 0.1 m
    const auto forces = [&](Eigen::Index j, Real by) {
        Real& x = body.position[static_cast<std::size_t>(j / 3)][j % 3];
        const Real before = x;
        x += by;
        body.compute_forces(*executor);
        x = before;
        return Eigen::Map<const Eigen::VectorXd>(body.force[0].data(), size).eval();
    };
    for (Eigen::Index j = 0; j < size; ++j) K.col(j) = (forces(j, -step) - forces(j, step)) / (2 * step);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index j = 0; j < size; ++j)
            K(i, j) /=
                std::sqrt(body.mass[static_cast<std::size_t>(i / 3)] * body.mass[static_cast<std::size_t>(j / 3)]);
    return symmetric_eigenvalues(0.5 * (K + K.transpose()))[size - 1];
}

/// Longest step for which symplectic Euler is stable [s].
inline Real exact_limit(ElasticBody& body) {
    return 2 / std::sqrt(exact_frequency_squared(body));
}

inline Real stable_step_of(const ElasticBody& body) {
    std::vector<Real> scratch(body.position.size());
    return stable_step(body.inputs(), body.blocks, body.position, body.mass, scratch).step;
}

}  // namespace skerry::test
