// Raises the assumed stiffness of clusters whose elements have become stiffer (docs/methods/clusters.md 3).
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
    std::span<const Real> body_cluster_step;  // 0: a body without clusters [s]
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

/// Data that depend on the stiffness of implicit elements.
struct StiffenOutputs {
    std::span<ElementLane> modulus;  // Pa, by block
    NodeClusters& clusters;          // only their matrices are written

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

/// Raises the assumed stiffness of implicit elements that come near it to twice their present stiffness, and updates
/// the matrices of their clusters. Returns the kinetic energy that this adds with unchanged velocities [J]. A stiffened
/// element keeps the momentum with which it deforms, not the velocity. The difference is an impulse of the step
/// (docs/methods/clusters.md 6). It is added to the forces of the elements, which act for `kick` [s], and to the
/// viscous impulses. Tests the blocks marked in `patches.stiffening` (compute_element_forces, for the same positions)
/// and clears the marks. Sequential, in element order.
Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, Real kick, const PatchForces& patches,
                      const StiffenOutputs& out);

/// Stiffens clusters between steps: tests every implicit element and leaves velocities as they are. Returns the kinetic
/// energy that this adds [J].
Real stiffen_all_clusters(const ElementInputs& elements, const StiffenInputs& bodies, const StiffenOutputs& out);

}  // namespace skerry
