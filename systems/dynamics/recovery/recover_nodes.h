// Recovers stress and strain at the nodes of a body from the values of its elements (docs/methods/elasticity.md 7.9).
#pragma once

#include <span>
#include <vector>

#include "components/types.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/recovery/recovery_plan.h"

namespace skerry {

/// Present state of a body with a recovery plan. The body must still have the elements for which the plan was made.
struct RecoveryState {
    ElementInputs elements;
    Range blocks;                    // element blocks of the body
    std::span<const Vec3> position;  // of all nodes, by the node numbers in `elements` [m]
    Index first_node;                // first node of the body in `position`
};

struct NodeFields {
    std::vector<Mat3> stress;        // Cauchy stress [Pa]
    std::vector<Mat3> strain;        // Green strain
    std::vector<bool> extrapolated;  // true for nodes at edges, corners and interfaces of materials
};

/// Recovers the fields at the nodes of the plan, in their order. Only elements near these nodes are evaluated. The
/// value at a node does not depend on which other nodes the plan contains. `compute_fields`: the kernel element_fields.
///
/// - Inner node: least-squares fit of the stresses of the elements around the node, quadratic for smoothed elements and
///   linear for others. Elements with only the volumetric part of the stress have a linear fit of their own, which is
///   added.
/// - Node of a smooth surface: stress that balances the traction, and agrees with the stretch of the surface.
/// - Node at an edge, a corner or an interface of materials: linear fit of the values at the nodes within two rings of
///   tetrahedra, for each material. The results of the materials are averaged by volume.
/// - Node with too few values around it for a fit: mean over the elements around the node.
NodeFields recover_nodes(const RecoveryPlan& plan, const RecoveryState& body, decltype(&element_fields) compute_fields);

}  // namespace skerry
