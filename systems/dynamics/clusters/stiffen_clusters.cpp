#include "systems/dynamics/clusters/stiffen_clusters.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "components/lanes.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/elements/quick_stiffness.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

// The assumed modulus of an element is raised when the present stiffness exceeds this fraction of the assumed modulus.
// This is early enough that the stiffness does not exceed the assumed modulus within the next step.
constexpr Real too_near = 0.9;
constexpr Real raised_to = 2;  // ratio of the new assumed modulus to the present stiffness

/// Adds a linear combination of the three vectors x, y, z in `from`: to += x factor.x + y factor.y + z factor.z. Both
/// loops evaluate the same expression, so an entry gets the same bits in the vector loop and in the remainder loop.
void add_combination(const std::array<std::vector<Real>, 3>& from, const Vec3& factor, std::span<Real> to) {
    const Real *const x = from[0].data(), *const y = from[1].data(), *const z = from[2].data();
    std::size_t i = 0;
    for (; i + element_lanes <= to.size(); i += element_lanes) {
        const auto at = [i](const Real* values) { return *reinterpret_cast<const Real8InMemory*>(values + i); };
        *reinterpret_cast<Real8InMemory*>(&to[i]) =
            at(to.data()) + (factor.x() * at(x) + factor.y() * at(y) + factor.z() * at(z));
    }
    for (; i < to.size(); ++i) to[i] += factor.x() * x[i] + factor.y() * y[i] + factor.z() * z[i];
}

/// Replaces the inverse A^-1 of a cluster's inertia matrix by (A + weight G G^T)^-1. Row k of G is the gradient of an
/// element's shape function of node k. Woodbury's identity subtracts U (1/weight + G^T U)^-1 U^T from A^-1, with
/// U = A^-1 G.
void add_to_inverse(const BlockNodes& block_nodes, std::size_t l, Real weight, std::span<const Real> inverse_mass,
                    const NodeClusters& clusters, std::span<Real> inverse) {
    Index cluster = no_index;
    for (Index k = 0; k < block_nodes.count && cluster == no_index; ++k)
        cluster = clusters.cluster(block_nodes.node[k][l]);
    if (cluster == no_index) return;
    const auto c = static_cast<std::size_t>(cluster);
    const std::size_t count = clusters.nodes[c].size();
    const auto for_each_node = [&](auto&& visit) {
        for (Index k = 0; k < block_nodes.count; ++k) {
            const auto n = static_cast<std::size_t>(block_nodes.node[k][l]);
            const Vec3 g(block_nodes.gradient[k][0][l], block_nodes.gradient[k][1][l], block_nodes.gradient[k][2][l]);
            if (inverse_mass[n] > 0 && !g.isZero(0)) visit(static_cast<std::size_t>(clusters.index_in_cluster[n]), g);
        }
    };
    std::array<std::vector<Real>, 3> moved;  // columns of U, later overwritten by columns of W
    for (std::vector<Real>& component : moved) component.assign(count, 0);
    for_each_node([&](std::size_t index, const Vec3& g) {
        const std::span<const Real> row = clusters.row(cluster, static_cast<Index>(index));
        for (Eigen::Index component = 0; component < 3; ++component) {
            std::vector<Real>& to = moved[static_cast<std::size_t>(component)];
            for (std::size_t i = 0; i < count; ++i) to[i] += row[i] * g[component];
        }
    });
    Mat3 small = Mat3::Identity() / weight;
    for_each_node([&](std::size_t index, const Vec3& g) {
        small += Vec3(moved[0][index], moved[1][index], moved[2][index]) * g.transpose();
    });
    // With C C^T = 1/weight + G^T U, the subtracted matrix is W W^T, W = U C^-T. It is bitwise symmetric in any order
    // of summation.
    const Mat3 C = small.llt().matrixL();
    for (std::size_t i = 0; i < count; ++i) {
        const Real x = moved[0][i] / C(0, 0), y = (moved[1][i] - C(1, 0) * x) / C(1, 1),
                   z = (moved[2][i] - C(2, 0) * x - C(2, 1) * y) / C(2, 2);
        moved[0][i] = x;
        moved[1][i] = y;
        moved[2][i] = z;
    }
    for (std::size_t i = 0; i < count; ++i)
        add_combination(moved, -Vec3(moved[0][i], moved[1][i], moved[2][i]),
                        inverse.subspan(clusters.first_entry[c] + i * count, count));
}

}  // namespace

namespace {

Vec3 lane_of(const LaneVec3<Real8>& v, std::size_t l) {
    return {v.x[l], v.y[l], v.z[l]};
}

/// Keeps the momentum of the deformation of an element constant while its inertia increases by `weight`
/// (docs/methods/clusters.md 6). F' is the rate of the deformation gradient, and g_k the gradient of the shape function
/// of node k. Adds
/// - the forces -weight F' g_k / kick, which act for the time `kick`, to the forces of the element on its nodes k,
/// - the impulse weight F' to its viscous impulse.
void keep_momentum(const ElementInputs& elements, const LaneMat3<Real8>& rate, std::size_t b, std::size_t l,
                   Real weight, Real kick, const PatchForces& patches) {
    const auto after = std::ranges::upper_bound(patches.blocks, static_cast<Index>(b), {}, &Range::begin);
    const Range slots = patches.slots[static_cast<std::size_t>(after - patches.blocks.begin()) - 1];
    const std::span<PaddedVec3> force =
        patches.force.subspan(static_cast<std::size_t>(slots.begin), static_cast<std::size_t>(slots.size()));
    const NodeLane* const slot = patches.slot.data() + elements.first[b];
    Mat3 impulse;
    impulse << lane_of(rate.c0, l), lane_of(rate.c1, l), lane_of(rate.c2, l);
    impulse *= weight;
    const auto add = [&](Index k, const Vec3& f) {
        for (std::size_t i = 0; i < 3; ++i)
            force[static_cast<std::size_t>(slot[k][l] / slot_width)].lane[i] += f[static_cast<Eigen::Index>(i)];
    };
    const BlockNodes nodes = elements.nodes_of(b);
    Vec3 sum = Vec3::Zero();
    for (Index k = 1; k < nodes.count; ++k) {
        const Vec3 g(nodes.gradient[k][0][l], nodes.gradient[k][1][l], nodes.gradient[k][2][l]);
        const Vec3 f = -(impulse * g) / kick;
        add(k, f);
        sum += f;
    }
    add(0, -sum);
    if (patches.viscous_impulse.empty()) return;
    if (!std::exchange(patches.viscous[b], std::uint8_t{1})) patches.viscous_impulse[b] = {};
    for (std::size_t i = 0; i < 9; ++i) patches.viscous_impulse[b][i][l] += impulse.data()[i];
}

/// Forces of the elements on their nodes in the step that begins. They act for the time `kick` [s].
struct StepForces {
    Real kick;
    const PatchForces& patches;
};

/// In one block, raises the assumed stiffness of those implicit elements whose present stiffness is close to it.
/// Returns the kinetic energy that the larger inertia adds [J]. `forces`: forces of the step, or null between steps.
Real stiffen_block(const ElementInputs& elements, const StiffenInputs& bodies, Real beta, std::size_t b,
                   const StepForces* forces, const StiffenOutputs& out) {
    const Real8 one = Real8{} + 1.0, zero{}, assumed = load(out.modulus[b]);
    if (all(assumed <= 0.0)) return 0;
    const LaneMat3<Real8> F = deformation_of(elements, b, bodies.position);
    if (all((assumed <= 0.0) | (quick_stiffness(elements.material_of(b), inner_product(F, F), determinant(F)) <=
                                near_stiffness * assumed)))
        return 0;
    LaneQuaternion<Real8> q{one, zero, zero, zero};
    if (less_stiff_than(elements, b, F, assumed, too_near, q)) return 0;
    const Real8 present = stiffness_of(elements, b, F, q);
    Real energy = 0;
    for (std::size_t l = 0; l < element_lanes; ++l) {
        if (!(assumed[l] > 0) || !(present[l] > too_near * assumed[l])) continue;
        const Real more = raised_to * present[l] - assumed[l];
        const Real weight = beta * more * elements.volume[b][l];
        out.modulus[b][l] += more;
        add_to_inverse(elements.nodes_of(b), l, weight, bodies.inverse_mass, out.clusters, out.clusters.inverse.span());
        const LaneMat3<Real8> rate = deformation_of(elements, b, bodies.velocity);
        energy += weight * inner_product(rate, rate)[l] / 2;
        if (forces != nullptr) keep_momentum(elements, rate, b, l, weight, forces->kick, forces->patches);
    }
    return energy;
}

/// Calls stiffen_block() for the blocks of awake bodies with clusters for which is_due(block) is true. Returns the
/// added kinetic energy [J], without that of ghosts (copies of bodies of other ranks).
template <class IsDue>
Real stiffen(const ElementInputs& elements, const StiffenInputs& bodies, const StepForces* forces,
             const StiffenOutputs& out, IsDue&& is_due) {
    Real energy = 0;
    for (std::size_t body = 0; body < bodies.body_blocks.size(); ++body) {
        if (!(bodies.body_cluster_step[body] > 0) || bodies.body_asleep[body]) continue;
        const Real beta = inertia_factor(bodies.body_cluster_step[body]);
        const Range blocks = bodies.body_blocks[body];
        const bool is_owned = !bodies.ghosts.contain(static_cast<Index>(body));
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            if (!is_due(b)) continue;
            const Real added = stiffen_block(elements, bodies, beta, b, forces, out);
            if (is_owned) energy += added;
        }
    }
    return energy;
}

}  // namespace

Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, Real kick, const PatchForces& patches,
                      const StiffenOutputs& out) {
    if (patches.stiffening.empty()) return 0;
    const StepForces forces{kick, patches};
    return stiffen(elements, bodies, &forces, out,
                   [&](std::size_t b) { return std::exchange(patches.stiffening[b], std::uint8_t{0}) != 0; });
}

Real stiffen_all_clusters(const ElementInputs& elements, const StiffenInputs& bodies, const StiffenOutputs& out) {
    return stiffen(elements, bodies, nullptr, out, [](std::size_t) { return true; });
}

}  // namespace skerry
