// Finds the relaxation rates of the elements of a new body (docs/methods/elasticity.md 6).
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Estimate of the lowest frequency at which a free body of this size and shape vibrates [1/s]. It is the smaller of
/// the frequencies of a beam and of a ball. The length and the thickness of the beam come from the radii of gyration of
/// the body. `speed`: speed of sound sqrt(E / rho) [m/s].
Real lowest_frequency_estimate(std::span<const Vec3> position, std::span<const Real> mass, Real speed);

/// Values that find_relaxation writes for each block of the body.
struct RelaxationOutputs {
    std::span<RelaxationRates> relaxation_rate;
    std::span<ElementLane> own_frequency;  // [1/s]
    std::span<Real> relaxing_share;
};

/// Finds the relaxation rates of the Maxwell elements that model the losses of a body, spread evenly over a band of
/// frequencies on a logarithmic scale (docs/methods/elasticity.md 6.1). All elements get the same rates, so that losses
/// depend neither on the position of an element nor on the number of elements. Sequential.
/// - `highest`: highest frequency of the body, the upper end of the band [1/s].
/// - `lowest`: estimate of the lowest frequency of the body [1/s]. The band begins at `lowest` / rates_below
///   (relaxation.h). This end is changed if the ratio of both ends is below 100 or above 10,000.
/// - `stiffness_sum`: stiffness sum by node, as in stable_step().
void find_relaxation(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, std::span<const Real> stiffness_sum, Real lowest, Real highest,
                     const RelaxationOutputs& out);

}  // namespace skerry
