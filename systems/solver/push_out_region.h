// Split impulse: takes contacts that are pressed in back out by moving positions only (methods.md 1.3 c, 4.3: as a velocity it would add
// energy).
#pragma once

#include <span>

#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// m, gaps above minus this are not worth a push: a resting contact solved to 1e-3 loses at most a thousandth of g h^2 a step, so this is a
/// hundred steps of drift; the second part is the rounding of positions some kilometres from the origin.
inline Real push_slop(Real gravity, Real h) {
    return 0.1 * gravity * h * h + 1e-12;
}

struct PushMemory {
    std::span<Real> impulse, bias;  // by contact
    std::span<Vec4> velocity;       // by node of the region; the result
};

/// Frictionless pseudo velocities p with u_n + p_n >= min(recovery |gap| / h, recovery_speed) where the gap is below the slop, and
/// elsewhere no approach that the velocity solve would not allow. Returns false, and writes nothing, when no contact is pressed in.
bool push_out_region(std::span<const LumpedContact> contact, std::span<const Index> row, std::span<const Real> gap,
                     std::span<const Vec4> velocity, Real gravity, const SolverSettings& settings, Real h, const PushMemory& memory);

}  // namespace skerry
