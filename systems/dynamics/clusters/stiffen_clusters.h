// Keeps clusters as stiff as their elements have become (docs/methods/clusters.md 3).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StiffenInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // s; 0: a body without clusters
    std::span<const std::uint8_t> body_asleep;
    std::span<const Vec3> position, velocity;
    std::span<const Real> inverse_mass;

    static StiffenInputs bind(const Binder& binder, const BodyTable& body, const NodeTable& node) {
        return {.body_blocks = binder.read(body.blocks),
                .body_cluster_step = binder.read(body.cluster_step),
                .body_asleep = binder.read(body.asleep),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .inverse_mass = binder.read(node.inverse_mass)};
    }
};

/// What follows the stiffness of implicit elements.
struct StiffenOutputs {
    std::span<ElementLane> modulus;  // Pa, by block
    NodeClusters& clusters;          // of which the matrices are written

    static StiffenOutputs bind(const Binder& binder, ElementBlockTable& element, NodeClusters& clusters) {
        binder.value(clusters.nodes);
        binder.value(clusters.body);
        binder.value(clusters.first_entry);
        binder.value(clusters.cluster_of);
        binder.value(clusters.place);
        binder.write(clusters.inverse);
        return {binder.write(element.implicit_modulus), clusters};
    }
};

/// Implicit elements that are about to become stiffer than they are taken to be are taken to be twice as stiff as they
/// are, and the matrices of their clusters follow. Returns what that adds to the kinetic energy, J, while velocities
/// stay; that an element is deformed with the momentum that it had and not with its velocity is an impulse of the step
/// (docs/methods/clusters.md 6), which comes to what elements do to their nodes for `kick` seconds, and to what is
/// viscous. Looks where `patches.stiffening` says so (compute_element_forces, of the same positions), and takes that
/// back. Sequential, in element order.
Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, Real kick, const PatchForces& patches,
                      const StiffenOutputs& out);

/// The same between steps, found by looking at every implicit element: velocities stay.
Real stiffen_all_clusters(const ElementInputs& elements, const StiffenInputs& bodies, const StiffenOutputs& out);

}  // namespace skerry
