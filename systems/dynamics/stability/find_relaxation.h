// Relaxation rates of the elements of a new body (docs/methods/elasticity.md 6).
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Estimate of the lowest frequency at which a free body of this size and shape vibrates [1/s]. It is that of a beam
/// with the length of the body and its least thickness (from radii of gyration), at most that of a ball. `speed`:
/// sqrt(E / rho) [m/s].
Real lowest_frequency_estimate(std::span<const Vec3> position, std::span<const Real> mass, Real speed);

/// Values written for each block of the body.
struct RelaxationOutputs {
    std::span<ElementLane> relaxation_rate;  // [1/s]
    std::span<ElementLane> own_frequency;    // [1/s]
    std::span<Real> relaxing_share;
};

/// Gives every element of a body one rate at which its stress relaxes. Rates are spread evenly on a logarithmic scale
/// between `highest`, the highest frequency of the body [1/s], and a twentieth of `lowest`, about its lowest.
/// Neighbours differ, and any part of more than some elements has all rates (coarse-grained memory variables, Day and
/// Bradley 2001). The rate depends on the place of an element in the shape at rest, so that the order of nodes and
/// elements does not matter. `stiffness_sum` is that of the stable step. Sequential.
void find_relaxation(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position,
                     std::span<const Vec3> position, std::span<const Real> mass, std::span<const Real> stiffness_sum,
                     Real lowest, Real highest, const RelaxationOutputs& out);

}  // namespace skerry
