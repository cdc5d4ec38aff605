#include "systems/dynamics/clusters/implicit_elements.h"

#include <algorithm>
#include <cmath>

#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/geometry/symmetric_eigen.h"

namespace skerry {

Real least_moment_of(const Mat3& spread) {
    const Vec3 along = symmetric_eigenvalues(spread);
    return along[0] + along[1];
}

void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real leeway_of_implicit,
                 std::span<ElementLane> leeway) {
    std::ranges::fill(leeway, ElementLane{{1, 1, 1, 1, 1, 1, 1, 1}});
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        if (!(modulus[e / element_lanes][e % element_lanes] > 0)) continue;
        for (const Index t : tetrahedra[e]) {
            const auto at = static_cast<std::size_t>(t);
            leeway[at / element_lanes][at % element_lanes] = leeway_of_implicit;
        }
    }
}

void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time) {
    // Viscous time of implicit elements divided by the step h. Clusters allow circular frequencies omega with omega h
    // up to 1.8. There this explicit damping lowers the stability limit of omega h from 2 to sqrt(4 - 0.2 * 1.8^2) =
    // 1.83, so the step stays stable (docs/methods/clusters.md 2.1).
    constexpr Real step_fraction = 0.1;
    for (std::size_t b = 0; b < modulus.size(); ++b)
        viscous_time[b] =
            std::ranges::any_of(modulus[b].lane, [](Real value) { return value > 0; }) ? step_fraction * step : 0;
}

Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus) {
    Real worst = 0;
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& assumed = modulus[b - static_cast<std::size_t>(blocks.begin)];
        if (std::none_of(assumed.lane, assumed.lane + element_lanes, [](Real m) { return m > 0; })) continue;
        const LaneMat3<Real8> F = deformation_of(elements, b, position);
        if (worst > 0 && less_stiff_than(elements, b, F, load(assumed), worst, q)) continue;
        const Real8 stiffness = stiffness_of(elements, b, F, q);
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (assumed[l] > 0) worst = std::max(worst, stiffness[l] / assumed[l]);
    }
    return worst;
}

Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity) {
    Real energy = 0;
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& assumed = modulus[b - static_cast<std::size_t>(blocks.begin)];
        const LaneMat3<Real8> rate = deformation_gradient(elements.nodes_of(b), velocity);
        const Real8 square = inner_product(rate, rate);
        for (std::size_t l = 0; l < element_lanes; ++l) energy += assumed[l] * elements.volume[b][l] * square[l];
    }
    return inertia_factor(step) * energy / 2;
}

Real moment_of_lumping(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                       std::span<const Vec3> position) {
    const auto for_each_tetrahedron = [&](auto&& visit) {
        for (std::size_t b = 0; b < node.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l)
                if (volume[b][l] > 0) visit(b, l, volume[b][l]);
    };
    const auto corner = [&](std::size_t b, std::size_t l, std::size_t a) {
        return position[static_cast<std::size_t>(node[b][a][l])];
    };
    Real whole = 0;              // m^3
    Vec3 center = Vec3::Zero();  // m
    for_each_tetrahedron([&](std::size_t b, std::size_t l, Real part) {
        whole += part;
        for (std::size_t a = 0; a < 4; ++a) center += part / 4 * corner(b, l, a);
    });
    if (!(whole > 0)) return 0;
    center /= whole;
    Mat3 lumped = Mat3::Zero(), spread = Mat3::Zero();  // integrals of x x^T over the volume [m^5]
    for_each_tetrahedron([&](std::size_t b, std::size_t l, Real part) {
        Vec3 sum = Vec3::Zero();
        Mat3 squares = Mat3::Zero();
        for (std::size_t a = 0; a < 4; ++a) {
            const Vec3 x = corner(b, l, a) - center;
            sum += x;
            squares += x * x.transpose();
        }
        lumped += part / 4 * squares;
        spread += part / 20 * (squares + sum * sum.transpose());
    });
    return least_moment_of(lumped) / least_moment_of(spread) - 1;
}

}  // namespace skerry
