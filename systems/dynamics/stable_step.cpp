#include "systems/dynamics/stable_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "components/check.h"
#include "systems/dynamics/element_block.h"
#include "systems/dynamics/element_stiffness.h"
#include "systems/material/linear.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

namespace {

/// Rest gradients of the four corners: the rows of B, and minus their sum for corner 0.
struct Gradients {
    LaneVec3<Real8> g[4];
};

Gradients gradients_of(const ElementRest& B) {
    const LaneVec3<Real8> g1{load(B[0]), load(B[3]), load(B[6])}, g2{load(B[1]), load(B[4]), load(B[7])},
        g3{load(B[2]), load(B[5]), load(B[8])};
    return {{-1.0 * (g1 + g2 + g3), g1, g2, g3}};
}

/// How stiff each corner is held: V |g_a|^2, times the bound of the material's Hessian where deformation changes it much.
std::array<Real8, 4> corner_stiffness(const ElementInputs& elements, std::size_t b, const LaneMat3<Real8>& F) {
    const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
    Real8 weight = load(elements.volume[b]);
    if (material.model == MaterialModel::stable_neo_hookean) weight = weight * stable_neo_hookean::stiffness_bound(material, F);
    const Gradients at = gradients_of(elements.inverse_rest[b]);
    return {weight * dot(at.g[0], at.g[0]), weight * dot(at.g[1], at.g[1]), weight * dot(at.g[2], at.g[2]), weight * dot(at.g[3], at.g[3])};
}

/// Sum over the corners of g_a g_a^T / m_a, the node's mass shared in proportion to stiffness: m_a = mass k_a / (sum of k at the node).
LaneMat3<Real8> inverse_mass_tensor(const ElementInputs& elements, std::size_t b, const LaneMat3<Real8>& F, std::span<const Real> mass,
                                    std::span<const Real> stiffness_sum) {
    const Gradients at = gradients_of(elements.inverse_rest[b]);
    const std::array<Real8, 4> stiffness = corner_stiffness(elements, b, F);
    LaneMat3<Real8> Q{};
    for (std::size_t a = 0; a < 4; ++a) {
        Real8 inverse{};
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const std::size_t n = static_cast<std::size_t>(elements.node[b][a][l]);
            // No mass: a node that never moves.
            if (mass[n] > 0 && elements.volume[b][l] > 0) inverse[l] = stiffness_sum[n] / (mass[n] * stiffness[a][l]);
        }
        const LaneVec3<Real8> scaled = inverse * at.g[a];
        Q = Q + LaneMat3<Real8>{at.g[a].x * scaled, at.g[a].y * scaled, at.g[a].z * scaled};
    }
    return Q;
}

}  // namespace

StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<const Real> mass,
                       std::span<Real> stiffness_sum) {
    SKERRY_CHECK(stiffness_sum.size() == position.size() && mass.size() == position.size());
    const std::size_t first = static_cast<std::size_t>(blocks.begin), end = static_cast<std::size_t>(blocks.end);
    const auto deformation = [&](std::size_t b) {
        return deformation_gradient(edges(elements.node[b], position), elements.inverse_rest[b]);
    };
    const auto for_each_corner = [&](std::size_t b, auto&& visit) {
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t l = 0; l < element_lanes; ++l) visit(stiffness_sum[static_cast<std::size_t>(elements.node[b][a][l])], a, l);
    };
    for (std::size_t b = first; b < end; ++b) for_each_corner(b, [](Real& sum, std::size_t, std::size_t) { sum = 0; });
    for (std::size_t b = first; b < end; ++b) {
        const std::array<Real8, 4> stiffness = corner_stiffness(elements, b, deformation(b));
        for_each_corner(b, [&](Real& sum, std::size_t a, std::size_t l) { sum += stiffness[a][l]; });
    }

    Real highest = 0;
    Index element = no_index;
    // The frame of a corotational element starts from the same lane of the block before it: neighbours turn together.
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::size_t b = first; b < end; ++b) {
        const LaneMat3<Real8> F = deformation(b);
        const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
        const LaneMat3<Real8> Q = inverse_mass_tensor(elements, b, F, mass, stiffness_sum);
        // The last term is nothing, or no number where F is none: not every bound looks at F.
        const Real8 bound = frequency_squared_bound(material, F, load(elements.volume[b]), Q, q) + 0.0 * inner_product(F, F);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Index here = static_cast<Index>(b * element_lanes + l);
            if (!(bound[l] <= std::numeric_limits<Real>::max())) return {0, here};  // a shape that is not finite has no stable step
            if (bound[l] > highest) {
                highest = bound[l];
                element = here;
            }
        }
    }
    constexpr Real safety = 0.9;
    return {element == no_index ? std::numeric_limits<Real>::infinity() : safety * 2 / std::sqrt(highest), element};
}

Real estimate_max_frequency_squared(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> inverse_mass, int iterations) {
    std::vector<Vec3> u(position.size()), next(position.size());
    // A start that no symmetry of the mesh makes orthogonal to the mode looked for.
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = Vec3(std::sin(12.9898 * static_cast<Real>(n + 1)), std::sin(78.233 * static_cast<Real>(n + 1)),
                    std::sin(37.719 * static_cast<Real>(n + 1)));
    Real estimate = 0;
    for (int i = 0; i < iterations; ++i) {
        // Rayleigh quotient of M^-1/2 K M^-1/2 at w = M^1/2 u, and u <- M^-1 K u.
        for (Vec3& x : next) x.setZero();
        for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            MaterialConstants material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            const Real8 one = Real8{} + 1.0, zero{};
            const LaneMat3<Real8> identity{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
            const LaneMat3<Real8> F = identity + deformation_gradient(edges(elements.node[b], u), elements.inverse_rest[b]);
            ElementForces force;
            spread_forces(linear::stress(material, F), elements.inverse_rest[b], load(elements.volume[b]), force);
            for (std::size_t l = 0; l < element_lanes; ++l)
                for (std::size_t a = 0; a < 4; ++a) next[static_cast<std::size_t>(elements.node[b][a][l])] -= force[l][a];
        }
        Real energy = 0, size = 0, largest = 0;
        for (std::size_t n = 0; n < u.size(); ++n) {
            if (!(inverse_mass[n] > 0)) {
                next[n].setZero();
                u[n].setZero();
                continue;
            }
            energy += u[n].dot(next[n]);
            size += u[n].squaredNorm() / inverse_mass[n];
            next[n] *= inverse_mass[n];
            largest = std::max(largest, next[n].cwiseAbs().maxCoeff());
        }
        if (!(largest > 0)) return 0;
        estimate = energy / size;
        for (std::size_t n = 0; n < u.size(); ++n) u[n] = next[n] / largest;
    }
    return estimate;
}

}  // namespace skerry
