// Finds bodies in pure translation, whose elements can be left out of a step (docs/methods/skipping.md 1.1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Tolerance for the entries of F: an element counts as strained or rotated if an entry differs from the unit matrix by
/// more. The tolerance is about a hundred times the rounding error of F for elements of 1 cm at 1 m from the origin.
inline constexpr Real unstrained_within = 1e-11;

/// Number of steps until the strains of an unstrained body are checked again. In this number of steps, rounding causes
/// a strain of about unstrained_within: in n steps it moves a node by at most n / 2 units in the last digit of its
/// position. For elements of 1 cm at 1 m from the origin, this is 512 * 2.2e-16 m / 1 cm = 1.1e-11.
inline constexpr std::uint16_t unstrained_steps = 1024;

struct UnstrainedInputs {
    ElementInputs elements;
    std::span<const Range> body_nodes, body_blocks;  // BodyTable
    std::span<const std::uint8_t> body_idle;         // BodyTable; empty if no body is idle
    std::span<const Vec3> position, velocity;
    std::span<const ElementRotation> rotation;

    static UnstrainedInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                                 const MaterialTable& material, const BodyTable& body, const NodeTable& node,
                                 const bool& any_idle) {
        return {.elements = ElementInputs::bind_explicit(binder, element, nodes, material),
                .body_nodes = binder.read(body.nodes),
                .body_blocks = binder.read(body.blocks),
                .body_idle = binder.read_if(binder.value(any_idle), body.idle),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .rotation = binder.read(element.rotation)};
    }
};

struct UnstrainedOutputs {
    std::span<std::uint16_t> unstrained;  // BodyTable
    std::span<ElementRotation> rotation_next;
    std::span<SpringStrain> spring_strain_next;

    static UnstrainedOutputs bind(const Binder& binder, BodyTable& body, ElementBlockTable& element) {
        return {.unstrained = binder.write(body.unstrained),
                .rotation_next = binder.write(element.rotation_next),
                .spring_strain_next = binder.write(element.spring_strain_next)};
    }
};

/// Finds the unstrained bodies among those that are not idle, updates `unstrained`, and returns their number. All nodes
/// of an unstrained body have bitwise the same velocity, and none of its elements is strained or rotated or has a
/// strained spring. Parallel over bodies.
///
/// - An unstrained body remains so while its node velocities are equal. Its strains are checked again only every
///   unstrained_steps steps.
/// - Code that changes node positions except by a time step must set `unstrained` to 0.
/// - Steps do not write the rotations and spring strains of the elements of an unstrained body, but they still swap the
///   columns of present and next values. When a body becomes unstrained, this function therefore makes rotation_next
///   and spring_strain_next equal to the present columns.
Index find_unstrained(Executor& executor, const UnstrainedInputs& inputs, const UnstrainedOutputs& out);

}  // namespace skerry
