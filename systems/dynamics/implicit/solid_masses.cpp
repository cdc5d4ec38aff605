#include "systems/dynamics/implicit/solid_masses.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace skerry {

Mat3 BodyShape::inertia() const {
    Mat3 second = Mat3::Zero();
    for (std::size_t k = 0; k < position.size(); ++k) second += position[k] * arm[k].transpose();
    second = (second + second.transpose().eval()) / 2;
    return second.trace() * Mat3::Identity() - second;
}

Vec3 BodyShape::angular_momentum(std::span<const Vec3> velocity) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < arm.size(); ++k) sum += arm[k].cross(velocity[k]);
    return sum;
}

SolidMasses::SolidMasses(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> mass,
                         std::span<const Index> order_index) {
    for (const std::array<Index, 4>& nodes : tetrahedra) {
        std::array<Index, 4>& corners = corners_.emplace_back();
        std::ranges::transform(nodes, corners.begin(),
                               [&](Index n) { return order_index[static_cast<std::size_t>(n)]; });
    }
    for (const Real of_tetrahedron : mass) share_.push_back(of_tetrahedron / 20);
}

void SolidMasses::find_arms(BodyShape& shape) const {
    // The lever arm of node k is the integral of rho N_k x, with the density rho, the shape function N_k and the
    // position x. Over a tetrahedron of mass m with the corners x_j it is m/20 (sum_j x_j + x_k).
    shape.arm.assign(shape.position.size(), Vec3::Zero());
    for (std::size_t t = 0; t < share_.size(); ++t) {
        Vec3 sum = Vec3::Zero();
        for (const Index k : corners_[t]) sum += shape.position[static_cast<std::size_t>(k)];
        for (const Index k : corners_[t])
            shape.arm[static_cast<std::size_t>(k)] += share_[t] * (sum + shape.position[static_cast<std::size_t>(k)]);
    }
}

}  // namespace skerry
