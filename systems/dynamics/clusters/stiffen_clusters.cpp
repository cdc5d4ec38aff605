#include "systems/dynamics/clusters/stiffen_clusters.h"

#include <Eigen/LU>
#include <algorithm>

#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

constexpr Real look_closer = 0.7, too_near = 0.9;  // of the modulus
constexpr Real raised_to = 2;                      // times what it is

/// Pa, a quick bound on the stiffness of each element; 0 where the law does not stiffen.
Real8 quick_stiffness(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F) {
    const MaterialConstants material = elements.material_of(block);
    Real8 stiffness{};
    with_law(material.model, [&](auto law) {
        if constexpr (law.stiffness_varies) stiffness = law.stiffness_bound(material, F);
    });
    return stiffness;
}

/// inverse = (A + weight G G^T)^-1 by what Woodbury's identity takes away, G = the gradients of the element by node.
void add_to_inverse(const BlockNodes& of, std::size_t l, Real weight, std::span<const Real> inverse_mass,
                    NodeClusters& clusters) {
    Index cluster = no_index;
    for (Index k = 0; k < of.count && cluster == no_index; ++k) cluster = clusters.cluster(of.node[k][l]);
    if (cluster == no_index) return;
    const auto c = static_cast<std::size_t>(cluster);
    const std::size_t count = clusters.nodes[c].size(), first = clusters.first_entry[c];
    const auto entry = [&](std::size_t i, std::size_t j) -> Real& { return clusters.inverse[first + i * count + j]; };
    Eigen::Matrix<Real, Eigen::Dynamic, 3> moved =
        Eigen::Matrix<Real, Eigen::Dynamic, 3>::Zero(static_cast<Eigen::Index>(count), 3);  // A^-1 G
    Mat3 small = Mat3::Identity() / weight;
    const auto for_each_node = [&](auto&& visit) {
        for (Index k = 0; k < of.count; ++k) {
            const auto n = static_cast<std::size_t>(of.node[k][l]);
            const Vec3 g(of.gradient[k][0][l], of.gradient[k][1][l], of.gradient[k][2][l]);
            if (inverse_mass[n] > 0 && !g.isZero(0)) visit(static_cast<std::size_t>(clusters.place[n]), g);
        }
    };
    for_each_node([&](std::size_t place, const Vec3& g) {
        for (std::size_t i = 0; i < count; ++i)
            moved.row(static_cast<Eigen::Index>(i)) += entry(place, i) * g.transpose();
    });
    for_each_node([&](std::size_t place, const Vec3& g) { small += g * moved.row(static_cast<Eigen::Index>(place)); });
    const Eigen::Matrix<Real, Eigen::Dynamic, 3> scaled = moved * small.inverse();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            entry(i, j) -= scaled.row(static_cast<Eigen::Index>(i)).dot(moved.row(static_cast<Eigen::Index>(j)));
            entry(j, i) = entry(i, j);  // symmetric to the last bit
        }
}

}  // namespace

Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, std::span<ElementLane> modulus,
                      NodeClusters& clusters) {
    Real energy = 0;
    const Real8 one = Real8{} + 1.0, zero{};
    for (std::size_t body = 0; body < bodies.body_blocks.size(); ++body) {
        if (!(bodies.body_cluster_step[body] > 0) || bodies.body_asleep[body]) continue;
        const Real beta = inertia_of_stiffness(bodies.body_cluster_step[body]);
        const Range blocks = bodies.body_blocks[body];
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            const Real8 taken = load(modulus[b]);
            if (all(taken <= 0.0)) continue;
            const LaneMat3<Real8> F = deformation_of(elements, b, bodies.position);
            if (all((taken <= 0.0) | (quick_stiffness(elements, b, F) <= look_closer * taken))) continue;
            LaneQuaternion<Real8> q{one, zero, zero, zero};
            const Real8 now = stiffness_of(elements, b, F, q);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                if (!(taken[l] > 0) || !(now[l] > too_near * taken[l])) continue;
                const Real more = raised_to * now[l] - taken[l];
                const Real weight = beta * more * elements.volume[b][l];
                modulus[b][l] += more;
                add_to_inverse(elements.nodes_of(b), l, weight, bodies.inverse_mass, clusters);
                const LaneMat3<Real8> rate = deformation_of(elements, b, bodies.velocity);
                energy += weight * inner_product(rate, rate)[l] / 2;
            }
        }
    }
    return energy;
}

}  // namespace skerry
