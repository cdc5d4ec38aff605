#include "systems/dynamics/stability/find_relaxation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "systems/dynamics/stability/stiffness_share.h"
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
    const Vec3 squares = Eigen::SelfAdjointEigenSolver<Mat3>(moment / total, Eigen::EigenvaluesOnly).eigenvalues();
    // A box of length L has the radius of gyration L / sqrt(12) along its length.
    const Real length = std::sqrt(12 * squares[2]), thickness = std::sqrt(12 * std::max(squares[0], Real{0}));
    // Lowest angular frequencies: 22.4 / L^2 sqrt(E I / (rho A)) of a free beam of length L, and about 3 c / L of a
    // ball or a cube of size L, where c = sqrt(E / rho) is the speed of sound.
    constexpr Real of_beam = 22.4 / 3.4641016151377544, of_ball = 3;
    return std::min(of_beam * thickness / length, of_ball) * speed / length;
}

namespace {

/// Mean size of the elements: edge of a cube with the mean volume of the elements [m].
Real mean_size(std::span<const ElementLane> volume) {
    Real sum = 0, count = 0;
    for (const ElementLane& lanes : volume)
        for (const Real v : lanes.lane) {
            sum += v;
            count += v > 0;
        }
    return count > 0 ? std::cbrt(sum / count) : 0;
}

/// Mean position of the nodes of an element [m].
Vec3 middle_of(const BlockNodes& nodes, std::size_t lane, std::span<const Vec3> position) {
    const Index anchor = nodes.node[0][lane];
    Vec3 sum = position[static_cast<std::size_t>(anchor)];
    Real count = 1;
    for (Index k = 1; k < nodes.count; ++k) {
        if (nodes.node[k][lane] == anchor) continue;  // padding, since the element has fewer nodes
        sum += position[static_cast<std::size_t>(nodes.node[k][lane])];
        ++count;
    }
    return sum / count;
}

/// Maps the position of an element, in units of the element size, to a number from 0 to 1. The fractional parts of
/// multiples of these three constants fill an interval evenly, along a row of elements as well as in a cloud of
/// elements. The constants are inverse powers of the root of x^4 = x + 1 (Roberts 2018).
Real share_of_place(const Vec3& place) {
    const Real sum = 0.8191725133961645 * place.x() + 0.6710436067037893 * place.y() + 0.5497004779019703 * place.z();
    return sum + 0.38196601125 - std::floor(sum + 0.38196601125);
}

}  // namespace

void find_relaxation(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position,
                     std::span<const Vec3> position, std::span<const Real> mass, std::span<const Real> stiffness_sum,
                     Real lowest, Real highest, const RelaxationOutputs& out) {
    constexpr Real least_span = 100, largest_span = 1e4;
    const Real span = lowest > 0 ? std::clamp(rates_below * highest / lowest, least_span, largest_span) : largest_span;
    const Real size = mean_size(
        elements.volume.subspan(static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size())));
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::size_t i = 0; i < out.relaxation_rate.size(); ++i) {
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + i;
        const Real8 squared =
            frequency_squared_of(elements, b, deformation_of(elements, b, position), mass, stiffness_sum, q);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            out.relaxation_rate[i][l] =
                highest * std::pow(span, -share_of_place(middle_of(elements.nodes_of(b), l, rest_position) / size));
            out.own_frequency[i][l] = std::sqrt(squared[l]);
        }
        const MaterialConstants material = elements.material_of(b);
        out.relaxing_share[i] = relaxing_share(material.loss_factor, span);
    }
}

}  // namespace skerry
