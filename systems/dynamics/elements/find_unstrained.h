// Bodies whose elements have nothing to do, since they only fly (docs/methods/skipping.md 1.1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// An element is strained, or turned, when an entry of F is further than this from that of the unit matrix: some
/// hundred times what rounding makes of elements of a centimetre a metre from the origin.
inline constexpr Real unstrained_within = 1e-11;

/// In so many steps rounding moves a node by that many half places of its position at most.
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

/// A body whose nodes all have the same velocity, bit by bit, and none of whose elements is strained or remembers that
/// it was, is unstrained; then on for as long as velocities are the same, looked at again every unstrained_steps steps.
/// What its elements remember for the next step is what they remember now. Whoever moves nodes otherwise than by their
/// velocities sets `unstrained` to 0. Returns how many are. Parallel over bodies.
Index find_unstrained(Executor& executor, const UnstrainedInputs& inputs, const UnstrainedOutputs& out);

}  // namespace skerry
