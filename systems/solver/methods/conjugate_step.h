// One iteration of projected conjugate gradients (pcg.h). This part is compiled for each operator.
#pragma once

#include <algorithm>
#include <span>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// Formula of the factor beta in the search direction: equation (17) or (18) of Lazarevych et al. (2010).
enum class ConjugateBeta { fletcher_reeves, polak_ribiere };

inline Real sum_of_products(std::span<const Vec4> a, std::span<const Vec4> b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

/// Largest absolute entries of the impulse change and of the residual in one iteration, for the end criteria (20) and
/// (21) of Lazarevych et al. (2010).
struct ConjugateChange {
    Real impulse = 0, residual = 0;
    bool used_up = false;  // true if no search direction is left
};

/// One iteration: the impulse moves along the search direction and is projected onto the friction law. The residual is
/// updated by equation (19) of Lazarevych et al. (2010).
template <ContactOperator Op>
ConjugateChange advance_conjugate_gradients(Op& op, ConjugateBeta formula) {
    const std::span<Vec4> impulse = op.impulse(), residual = op.workspace(1), direction = op.workspace(2),
                          product = op.workspace(3);
    op.multiply(direction, product);
    const Real squared = sum_of_products(residual, residual);
    const Real curvature = sum_of_products(direction, product);
    if (!(curvature > 0) || !(squared > 0)) return {0, 0, true};
    const Real alpha = squared / curvature;
    Real squared_next = 0, with_previous = 0;
    ConjugateChange change;
    for (std::size_t i = 0; i < impulse.size(); ++i) {
        const Vec4 before = impulse[i];
        const Vec4 residual_before = residual[i];
        impulse[i] = op.project(static_cast<Index>(i), before + alpha * direction[i]);
        residual[i] = op.feasible(static_cast<Index>(i), residual_before - alpha * product[i]);
        squared_next += residual[i].dot(residual[i]);
        with_previous += residual[i].dot(residual_before);
        change.impulse = std::max(change.impulse, (impulse[i] - before).cwiseAbs().maxCoeff());
        change.residual = std::max(change.residual, residual[i].cwiseAbs().maxCoeff());
    }
    const Real numerator = formula == ConjugateBeta::fletcher_reeves ? squared_next : squared_next - with_previous;
    const Real beta = numerator / squared;
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = residual[i] + beta * direction[i];
    return change;
}

}  // namespace skerry
