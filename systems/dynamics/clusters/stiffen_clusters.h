// Raises the assumed stiffness of implicit elements that have become stiffer, and updates their clusters
// (docs/methods/clusters.md 3).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/ghost_marks.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StiffenInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // longest step at which the clusters are stable; 0 without clusters [s]
    std::span<const std::uint8_t> body_asleep;
    std::span<const Vec3> position, velocity;
    std::span<const Real> inverse_mass;
    GhostMarks ghosts = {};  // copies of bodies of other ranks: stiffened, but do not count in the energy

    static StiffenInputs bind(const Binder& binder, const BodyTable& body, const NodeTable& node) {
        return {.body_blocks = binder.read(body.blocks),
                .body_cluster_step = binder.read(body.cluster_step),
                .body_asleep = binder.read(body.asleep),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .inverse_mass = binder.read(node.inverse_mass),
                .ghosts = {binder.read(body.ghost)}};
    }
};

/// Outputs of a stiffening: the assumed moduli of implicit elements, and the cluster matrices that depend on them.
struct StiffenOutputs {
    std::span<ElementLane> modulus;  // Pa, by block
    NodeClusters& clusters;          // only the inverse matrices of the clusters are written

    static StiffenOutputs bind(const Binder& binder, ElementBlockTable& element, NodeClusters& clusters) {
        binder.value(clusters.nodes);
        binder.value(clusters.body);
        binder.value(clusters.first_entry);
        binder.value(clusters.cluster_of);
        binder.value(clusters.index_in_cluster);
        binder.write(clusters.inverse);
        return {binder.write(element.implicit_modulus), clusters};
    }
};

/// Raises the assumed stiffness of implicit elements whose present stiffness exceeds 0.9 times the assumed stiffness,
/// to twice the present stiffness. Updates the inertia matrices of the clusters concerned. Returns the kinetic energy
/// that the larger inertia adds at unchanged velocities, without that of ghosts (bodies of other ranks) [J].
/// Sequential, in element order.
///
/// - The momentum of the deformation of a stiffened element stays constant, so its rate of deformation decreases. The
///   impulse that causes this (docs/methods/clusters.md 6) is added to the element forces, which act for the time
///   `kick` [s], and to the viscous impulses.
/// - Tests only the blocks that compute_element_forces has marked in `patches.stiffening` for the present node
///   positions, and clears these marks.
Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, Real kick, const PatchForces& patches,
                      const StiffenOutputs& out);

/// Raises the assumed stiffness of implicit elements between two steps. Tests every implicit element and leaves
/// velocities unchanged. Returns the kinetic energy that the larger inertia adds, without that of ghosts [J].
Real stiffen_all_clusters(const ElementInputs& elements, const StiffenInputs& bodies, const StiffenOutputs& out);

}  // namespace skerry
