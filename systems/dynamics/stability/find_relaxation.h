// How the elements of a new body relax (docs/methods/elasticity.md 6).
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// 1/s, about the lowest frequency at which a free body of this size and shape vibrates: that of a beam as long as the
/// body is and as thick as it is where it is thinnest (radii of gyration), at most that of a ball. `speed`: m/s,
/// sqrt(E / rho).
Real lowest_frequency_estimate(std::span<const Vec3> position, std::span<const Real> mass, Real speed);

/// What is written of each block of the body.
struct RelaxationOutputs {
    std::span<ElementLane> relaxation_rate;  // 1/s
    std::span<ElementLane> own_frequency;    // 1/s
    std::span<Real> relaxing_share;
};

/// Every element of a body has one rate at which its stress relaxes. Rates are dealt out evenly on a logarithmic scale
/// between `highest`, the highest frequency of the body (1/s), and a twentieth of `lowest`, about its lowest, so that
/// neighbours differ and any part of more than some elements has them all (coarse-grained memory variables, Day and
/// Bradley 2001). Which element gets which goes by its place in the shape at rest, so that the order of nodes and
/// elements does not matter. `stiffness_sum` is that of the stable step. Sequential.
void find_relaxation(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position,
                     std::span<const Vec3> position, std::span<const Real> mass, std::span<const Real> stiffness_sum,
                     Real lowest, Real highest, const RelaxationOutputs& out);

}  // namespace skerry
