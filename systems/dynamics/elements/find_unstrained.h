// Finds bodies in pure translation, whose elements can be left out (docs/methods/skipping.md 1.1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// An element is strained or rotated if an entry of F differs from that of the unit matrix by more than this. It is
/// some hundred times the rounding error of elements of a centimetre at a metre from the origin.
inline constexpr Real unstrained_within = 1e-11;

/// Steps until an unstrained body is checked again. In as many steps rounding moves a node by at most as many half
/// units in the last place of its position.
inline constexpr std::uint16_t unstrained_steps = 1024;

struct UnstrainedInputs {
    ElementInputs elements;
    std::span<const Range> body_nodes, body_blocks;  // BodyTable
    std::span<const std::uint8_t> body_asleep;       // BodyTable
    std::span<const Vec3> position, velocity;
    std::span<const ElementRotation> rotation;

    static UnstrainedInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                                 const MaterialTable& material, const BodyTable& body, const NodeTable& node) {
        return {.elements = ElementInputs::bind_explicit(binder, element, nodes, material),
                .body_nodes = binder.read(body.nodes),
                .body_blocks = binder.read(body.blocks),
                .body_asleep = binder.read(body.asleep),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .rotation = binder.read(element.rotation)};
    }
};

struct UnstrainedOutputs {
    std::span<std::uint16_t> unstrained;  // BodyTable
    std::span<ElementRotation> rotation_next;
    std::span<ElementStrain> viscous_strain_next;

    static UnstrainedOutputs bind(const Binder& binder, BodyTable& body, ElementBlockTable& element) {
        return {.unstrained = binder.write(body.unstrained),
                .rotation_next = binder.write(element.rotation_next),
                .viscous_strain_next = binder.write(element.viscous_strain_next)};
    }
};

/// A body is unstrained if all its nodes have bitwise the same velocity and none of its elements is strained or has a
/// viscous strain. It stays unstrained while the velocities are equal; strains are checked again every unstrained_steps
/// steps. Its elements keep their memory for the next step. Code that moves nodes other than by their velocities has to
/// set `unstrained` to 0. Returns the number of unstrained bodies. Parallel over bodies.
Index find_unstrained(Executor& executor, const UnstrainedInputs& inputs, const UnstrainedOutputs& out);

}  // namespace skerry
