// Estimate of the largest eigenvalue of D^-1 W, D_i the mobility of contact i. It sets the step length of gradient
// methods.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "systems/solver/operators/contact_operator.h"

namespace skerry::lab {

/// Estimates the eigenvalue from below, to a few percent, by `steps` products. The start vector is pseudo-random so
/// that no eigenvector is missed. The result is at least 1. Uses workspaces 1 and 2. `restrict_to(i, vector)` returns
/// the part of a vector that counts for contact i.
template <ContactOperator Op, class Restrict>
Real largest_eigenvalue(Op& op, Index steps, const Restrict& restrict_to) {
    const std::span<Vec4> vector = op.workspace(1), product = op.workspace(2);
    std::uint32_t state = 1;
    const auto number = [&state] {  // pseudo-random in [-1, 1), identical on every machine
        state = state * 1664525u + 1013904223u;
        return static_cast<Real>(state >> 8) / (1 << 23) - 1;
    };
    for (Index i = 0; i < op.size(); ++i) {
        const Real x = number(), y = number(), z = number();
        vector[i] = op.mobility(i) > 0 ? restrict_to(i, Vec4(x, y, z, 0)) : Vec4(Vec4::Zero());
    }
    Real eigenvalue = 1;
    for (Index step = 0; step < steps; ++step) {
        op.multiply(vector, product);
        Real along = 0, size = 0;  // v . W v and v . D v
        for (Index i = 0; i < op.size(); ++i) {
            along += vector[i].dot(product[i]);
            size += op.mobility(i) * vector[i].squaredNorm();
        }
        if (!(size > 0) || !(along > 0)) break;
        eigenvalue = std::max(eigenvalue, along / size);
        const Real shorter = 1 / std::sqrt(size);
        for (Index i = 0; i < op.size(); ++i)
            if (op.mobility(i) > 0) vector[i] = restrict_to(i, Vec4((shorter / op.mobility(i)) * product[i]));
    }
    return eigenvalue;
}

}  // namespace skerry::lab
