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
    // Relaxing stress; empty: nothing relaxes
    std::span<const ElementLane> relaxation_rate = {}, own_frequency = {};  // 1/s
    std::span<const Real> relaxing_share = {};
    std::span<const ElementStrain> viscous_strain = {};
    // BodyTable. Elements of bodies that are asleep or unstrained are left out of a step; empty: no such body
    std::span<const std::uint8_t> body_asleep = {};
    std::span<const std::uint16_t> body_unstrained = {};
    std::span<const ElementForm> mass_form = {};         // 1/(kg m^2); empty: elements use mass_share
    std::span<const ElementLane> implicit_modulus = {};  // Pa; 0: an explicit element; empty: all are explicit
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
    /// True if a block is left out of this step.
    bool is_left_out(std::size_t block) const {
        return (!body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[block])]) ||
               (!body_unstrained.empty() && body_unstrained[static_cast<std::size_t>(body[block])]);
    }

    /// Binds all elements.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material) {
        ElementInputs elements = bind_explicit(binder, element, nodes, material);
        elements.implicit_modulus = binder.read(element.implicit_modulus);
        return elements;
    }
    /// Binds all elements and marks those that are left out of a step. `any_asleep`: true if some body is asleep.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material, const BodyTable& body, const bool& any_asleep) {
        ElementInputs elements = bind(binder, element, nodes, material);
        elements.body_asleep = binder.read_if(binder.value(any_asleep), body.asleep);
        elements.body_unstrained = binder.read(body.unstrained);
        return elements;
    }
    /// Binds all elements without implicit_modulus, for readers that need not wait until it is written.
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

/// Fraction of the assumed stiffness of an implicit element. If the quick bound is above it, the stiffness is computed
/// accurately.
inline constexpr Real near_stiffness = 0.7;

/// The patches and the columns of their sums.
struct PatchForces {
    std::span<const Range> blocks, slots;
    std::span<const Index> node;                            // by slot
    std::span<const NodeLane> slot;                         // by row of ElementNodeTable: slot_width times the slot
    std::span<PaddedVec3> position;                         // m, by slot; scratch
    std::span<PaddedVec3> force;                            // N, by slot
    std::span<ElementViscousImpulse> viscous_impulse = {};  // by block; empty: nothing is viscous
    std::span<std::uint8_t> viscous = {};                   // by block: 1 if it has a viscous impulse in this step
    // by block that is not left out: 1 if the quick bound of an implicit element is above near_stiffness
    std::span<std::uint8_t> stiffening = {};
    std::span<Real> relaxed = {};  // energy that relaxed, by patch; empty: nothing relaxes [J]

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

/// State of the elements that this step writes for the next one.
struct ElementMemory {
    std::span<ElementRotation> rotation;
    // Viscous strain after this step; until that is written, the one before the last step. Empty: nothing relaxes.
    std::span<ElementStrain> viscous_strain = {};

    static ElementMemory bind(const Binder& binder, ElementBlockTable& element) {
        return {.rotation = binder.write(element.rotation_next),
                .viscous_strain = binder.write(element.viscous_strain_next)};
    }
};

/// Sums over each patch the forces of its elements on its nodes, from the first Piola-Kirchhoff stress P(F),
/// F = sum_k (x_k - x_0) (x) g_k: f_k = -V P g_k, f_0 = -(f_1 + f_2 + ...). Sums go in the order of the blocks, and
/// lane by lane: the same bits on any number of workers. Corotational elements start the extraction of their frame from
/// `rotation` and write next.rotation; other models write no frame. Patches of bodies that are left out keep their
/// forces. `kick`: time for which forces act [s]. `kick_over_last`: `kick` over that of the step before; 0 if
/// next.viscous_strain no longer holds the strain from before that step. With 0 the dissipated energy is exact to
/// first order only (docs/methods/elasticity.md 6.2). Returns the dissipated energy [J]. Parallel over patches.
Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real kick, Real kick_over_last,
                            std::span<const ElementRotation> rotation, const ElementMemory& next,
                            const PatchForces& patches);

}  // namespace skerry
