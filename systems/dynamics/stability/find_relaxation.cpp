#include "systems/dynamics/stability/find_relaxation.h"

#include <algorithm>
#include <cmath>

#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/geometry/symmetric_eigen.h"
#include "systems/material/relaxation.h"

namespace skerry {

Real lowest_frequency_estimate(std::span<const Vec3> position, std::span<const Real> mass, Real speed) {
    Real total = 0;
    Vec3 center = Vec3::Zero();
    for (std::size_t n = 0; n < position.size(); ++n) {
        total += mass[n];
        center += mass[n] * position[n];
    }
    if (!(total > 0)) return 0;
    center /= total;
    Mat3 moment = Mat3::Zero();
    for (std::size_t n = 0; n < position.size(); ++n)
        moment += mass[n] * (position[n] - center) * (position[n] - center).transpose();
    const Vec3 squares = symmetric_eigenvalues(moment / total);
    // A box of length L has the radius of gyration L / sqrt(12) along its length.
    const Real length = std::sqrt(12 * squares[2]), thickness = std::sqrt(12 * std::max(squares[0], Real{0}));
    // Lowest angular frequency, with Young's modulus E, density rho and speed of sound c = sqrt(E / rho):
    // - free beam of length L: 22.4 / L^2 sqrt(E I / (rho A)), where sqrt(I / A) = thickness / sqrt(12)
    // - ball or cube of size L: about 3 c / L
    constexpr Real of_beam = 22.4 / 3.4641016151377544, of_ball = 3;
    return std::min(of_beam * thickness / length, of_ball) * speed / length;
}

void find_relaxation(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, std::span<const Real> stiffness_sum, Real lowest, Real highest,
                     const RelaxationOutputs& out) {
    constexpr Real least_span = 100, largest_span = 1e4;
    const Real span = lowest > 0 ? std::clamp(rates_below * highest / lowest, least_span, largest_span) : largest_span;
    std::ranges::fill(out.relaxation_rate, relaxation_rates(highest, span));
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::size_t i = 0; i < out.relaxing_share.size(); ++i) {
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + i;
        const Real8 squared =
            frequency_squared_of(elements, b, deformation_of(elements, b, position), mass, stiffness_sum, q);
        for (std::size_t l = 0; l < element_lanes; ++l) out.own_frequency[i][l] = std::sqrt(squared[l]);
        const MaterialConstants material = elements.material_of(b);
        out.relaxing_share[i] = relaxing_share(material.loss_factor, span);
    }
}

}  // namespace skerry
