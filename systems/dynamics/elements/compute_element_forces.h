// Elastic forces of the elements (docs/methods/elasticity.md 1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/material_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct ElementInputs {
    std::span<const Index> first, count;  // rows of the two below, by block
    std::span<const NodeLane> node;
    std::span<const ElementGradient> gradient;
    std::span<const ElementLane> volume;
    std::span<const ElementLane> mass_share;
    std::span<const Index> material;
    std::span<const ElementPart> part;
    std::span<const MaterialConstants> constants;
    std::span<const Index> body = {};         // row of BodyTable, by block; may be empty if no body is left out
    std::span<const Real> viscous_time = {};  // s; empty: nothing is viscous
    // Of what relaxes; empty: nothing does
    std::span<const ElementLane> relaxation_rate = {}, own_frequency = {};  // 1/s
    std::span<const Real> relaxing_share = {};
    std::span<const ElementStrain> viscous_strain = {};
    // BodyTable. Elements of bodies that rest, or are unstrained, have nothing to do in a step; empty: no such body
    std::span<const std::uint8_t> body_asleep = {};
    std::span<const std::uint16_t> body_unstrained = {};
    std::span<const ElementForm> mass_form = {};         // 1/(kg m^2); empty: elements go by mass_share
    std::span<const ElementLane> implicit_modulus = {};  // Pa; 0: an explicit element; empty: all are
    std::span<const FrameMass> frame_mass = {};
    std::span<const Real> frame_bound = {};  // 1/s^2; empty: no body has frame masses

    std::size_t blocks() const { return first.size(); }
    BlockNodes nodes_of(std::size_t block) const {
        const auto row = static_cast<std::size_t>(first[block]);
        return {node.data() + row, gradient.data() + row, count[block]};
    }
    MaterialConstants material_of(std::size_t block) const {
        return part_of(constants[static_cast<std::size_t>(material[block])], part[block]);
    }
    /// Whether a block does nothing in this step.
    bool is_left_out(std::size_t block) const {
        return (!body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[block])]) ||
               (!body_unstrained.empty() && body_unstrained[static_cast<std::size_t>(body[block])]);
    }

    /// All elements.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material) {
        ElementInputs elements = bind_explicit(binder, element, nodes, material);
        elements.implicit_modulus = binder.read(element.implicit_modulus);
        return elements;
    }
    /// Those that have something to do in a step. `any_asleep`: some body rests.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material, const BodyTable& body, const bool& any_asleep) {
        ElementInputs elements = bind(binder, element, nodes, material);
        elements.body_asleep = binder.read_if(binder.value(any_asleep), body.asleep);
        elements.body_unstrained = binder.read(body.unstrained);
        return elements;
    }
    /// All elements, for who does not ask what implicit ones are taken to have, and need not wait for it.
    static ElementInputs bind_explicit(const Binder& binder, const ElementBlockTable& element,
                                       const ElementNodeTable& nodes, const MaterialTable& material) {
        return {.first = binder.read(element.first),
                .count = binder.read(element.count),
                .node = binder.read(nodes.node),
                .gradient = binder.read(nodes.gradient),
                .volume = binder.read(element.volume),
                .mass_share = binder.read(element.mass_share),
                .material = binder.read(element.material),
                .part = binder.read(element.part),
                .constants = binder.read(material.constants),
                .body = binder.read(element.body),
                .viscous_time = binder.read(element.viscous_time),
                .relaxation_rate = binder.read(element.relaxation_rate),
                .own_frequency = binder.read(element.own_frequency),
                .relaxing_share = binder.read(element.relaxing_share),
                .viscous_strain = binder.read(element.viscous_strain),
                .mass_form = binder.read(element.mass_form),
                .frame_mass = binder.read(element.frame_mass),
                .frame_bound = binder.read(element.frame_bound)};
    }
};

/// Of the stiffness that an implicit element is taken to have: what comes that near is looked at closely.
inline constexpr Real near_stiffness = 0.7;

/// The patches and where their sums go.
struct PatchForces {
    std::span<const Range> blocks, slots;
    std::span<const Index> node;                            // by slot
    std::span<const NodeLane> slot;                         // by row of ElementNodeTable: slot_width times the slot
    std::span<PaddedVec3> position;                         // m, by slot; scratch
    std::span<PaddedVec3> force;                            // N, by slot
    std::span<ElementViscousImpulse> viscous_impulse = {};  // by block; empty: nothing is viscous
    std::span<std::uint8_t> viscous = {};                   // by block: whether it has one in this step
    // by block that is not left out: whether the quick bound of an implicit element is above near_stiffness
    std::span<std::uint8_t> stiffening = {};
    std::span<Real> relaxed = {};  // J, by patch; empty: nothing relaxes

    static PatchForces bind(const Binder& binder, ElementPatches& patches, const ElementNodeTable& nodes) {
        return {.blocks = binder.read(patches.blocks),
                .slots = binder.read(patches.slots),
                .node = binder.read(patches.node),
                .slot = binder.read(nodes.slot),
                .position = binder.write(patches.position),
                .force = binder.write(patches.force),
                .viscous_impulse = binder.write(patches.viscous_impulse),
                .viscous = binder.write(patches.viscous),
                .stiffening = binder.write(patches.stiffening),
                .relaxed = binder.write(patches.relaxed)};
    }
};

/// What elements will remember of this step.
struct ElementMemory {
    std::span<ElementRotation> rotation;
    // What dashpots have taken: of this step; until that is written, of before the last one. Empty: nothing relaxes.
    std::span<ElementStrain> viscous_strain = {};

    static ElementMemory bind(const Binder& binder, ElementBlockTable& element) {
        return {.rotation = binder.write(element.rotation_next),
                .viscous_strain = binder.write(element.viscous_strain_next)};
    }
};

/// Sums over each patch what its elements do to its nodes, from the first Piola-Kirchhoff stress P(F),
/// F = sum_k (x_k - x_0) (x) g_k: f_k = -V P g_k, f_0 = -(f_1 + f_2 + ...). In the order of the blocks, and lane by
/// lane: the same bits on any number of workers. Corotational elements start the extraction of their frame from
/// `rotation` and leave the result in `rotation_next`; those of other models copy nothing. Patches of bodies that are
/// left out keep what they had. `kick`: s, for which they act; `kick_over_last`: over that of the step before, of which
/// next.viscous_strain still knows what relaxed, 0 where it does not: then what is booked as relaxed is exact to first
/// order only (docs/methods/elasticity.md 6.2). Parallel over patches.
Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real kick, Real kick_over_last,
                            std::span<const ElementRotation> rotation, const ElementMemory& next,
                            const PatchForces& patches);

}  // namespace skerry
