// Elastic forces of the elements (docs/methods/elasticity.md 1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/ghost_marks.h"
#include "components/material_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/material/orthotropic.h"

namespace skerry {

struct ElementInputs {
    std::span<const Index> first, count;  // by block: first row in `node` and `gradient`, and number of rows
    std::span<const NodeLane> node;
    std::span<const ElementGradient> gradient;
    std::span<const ElementLane> volume;
    std::span<const ElementLane> mass_share;
    std::span<const Index> material;
    std::span<const ElementPart> part;
    std::span<const MaterialConstants> constants;
    std::span<const Mat3> orientation = {};   // may be empty if no material is anisotropic
    std::span<const Index> body = {};         // row of BodyTable by block; may be empty if no body is left out
    std::span<const Real> viscous_time = {};  // viscosity / modulus by block; may be empty if none is viscous [s]
    // The next four spans describe the Maxwell elements, whose stress relaxes; they may be empty if no material
    // relaxes.
    std::span<const RelaxationRates> relaxation_rate = {};
    std::span<const ElementLane> own_frequency = {};  // 1/s
    std::span<const Real> relaxing_share = {};
    std::span<const SpringStrain> spring_strain = {};
    // Columns of BodyTable. Elements of idle bodies (asleep, or ghosts whose forces only the owning rank computes) and
    // of unstrained bodies (in translation without strain) are left out of a step. An empty span means that there are
    // no such bodies.
    std::span<const std::uint8_t> body_idle = {};
    std::span<const std::uint16_t> body_unstrained = {};
    std::span<const ElementForm> mass_form = {};  // may be empty if all elements use mass_share [1/(kg m^2)]
    // Assumed modulus; 0 for an explicit element; empty if not bound (bind_explicit) [Pa]
    std::span<const ElementLane> implicit_modulus = {};
    std::span<const FrameMass> frame_mass = {};
    std::span<const Real> frame_bound = {};  // may be empty if no body has frame masses [1/s^2]
    GhostMarks ghosts = {};                  // copies of bodies of other ranks: computed, but do not count in energies

    std::size_t blocks() const { return first.size(); }
    BlockNodes nodes_of(std::size_t block) const {
        const auto row = static_cast<std::size_t>(first[block]);
        return {node.data() + row, gradient.data() + row, count[block]};
    }
    MaterialConstants material_of(std::size_t block) const { return part_of(whole_material_of(block), part[block]); }
    /// Constants for the whole stress, with the axes of the material rotated by the orientation of the block.
    MaterialConstants whole_material_of(std::size_t block) const {
        MaterialConstants whole = constants[static_cast<std::size_t>(material[block])];
        if (whole.model == MaterialModel::orthotropic && !orientation.empty()) turn_axes(orientation[block], whole);
        return whole;
    }
    /// True if the elements of a block are left out of this step.
    bool is_left_out(std::size_t block) const {
        return (!body_idle.empty() && body_idle[static_cast<std::size_t>(body[block])]) ||
               (!body_unstrained.empty() && body_unstrained[static_cast<std::size_t>(body[block])]);
    }

    /// True if a block belongs to a ghost, whose owner counts its energy.
    bool is_of_ghost(std::size_t block) const { return ghosts.contain(body.empty() ? no_index : body[block]); }

    /// Binds all elements.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material) {
        ElementInputs elements = bind_explicit(binder, element, nodes, material);
        elements.implicit_modulus = binder.read(element.implicit_modulus);
        return elements;
    }
    /// Binds all elements, and the flags that show which elements are left out of a step. `any_idle`: true if at
    /// least one body is idle.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const ElementNodeTable& nodes,
                              const MaterialTable& material, const BodyTable& body, const bool& any_idle) {
        ElementInputs elements = bind(binder, element, nodes, material);
        elements.body_idle = binder.read_if(binder.value(any_idle), body.idle);
        elements.body_unstrained = binder.read(body.unstrained);
        elements.ghosts = {binder.read(body.ghost)};
        return elements;
    }
    /// Binds all elements without implicit_modulus, for stages that then need not wait for the stage that writes this
    /// column.
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
                .orientation = binder.read(element.orientation),
                .body = binder.read(element.body),
                .viscous_time = binder.read(element.viscous_time),
                .relaxation_rate = binder.read(element.relaxation_rate),
                .own_frequency = binder.read(element.own_frequency),
                .relaxing_share = binder.read(element.relaxing_share),
                .spring_strain = binder.read(element.spring_strain),
                .mass_form = binder.read(element.mass_form),
                .frame_mass = binder.read(element.frame_mass),
                .frame_bound = binder.read(element.frame_bound)};
    }
};

/// Upper limit on quick_stiffness() of an implicit element, as a fraction of the assumed stiffness. Above this limit
/// the stiffness is computed accurately.
inline constexpr Real near_stiffness = 0.7;

/// Patches of elements, and columns for the forces and the dissipated energy of each patch.
struct PatchForces {
    std::span<const Range> blocks, slots;
    std::span<const Index> node;  // by slot: row of NodeTable
    // slot of each element node in its patch, as an offset in reals (index of the slot times slot_width)
    std::span<const NodeLane> slot;
    std::span<PaddedVec3> position;                         // by slot [m]; work memory
    std::span<PaddedVec3> force;                            // N, by slot
    std::span<ElementViscousImpulse> viscous_impulse = {};  // viscous impulse by block; empty if no element is viscous
    std::span<std::uint8_t> viscous = {};                   // 1 if the block has a viscous impulse in this step
    // 1 if quick_stiffness() of an implicit element of the block is above near_stiffness times its assumed stiffness.
    // Blocks that are left out are not written.
    std::span<std::uint8_t> stiffening = {};
    std::span<Real> relaxed = {};  // energy that the dashpots of a patch dissipate; may be empty if there are none [J]

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

/// State of the elements that a step writes for the next step.
struct ElementMemory {
    std::span<ElementRotation> rotation;
    // strains of the springs of Maxwell elements in this step; may be empty if no material relaxes
    std::span<SpringStrain> spring_strain = {};

    static ElementMemory bind(const Binder& binder, ElementBlockTable& element) {
        return {.rotation = binder.write(element.rotation_next),
                .spring_strain = binder.write(element.spring_strain_next)};
    }
};

/// Computes the forces of the elements on their nodes, and sums the forces over each patch. Returns the energy that the
/// dashpots of Maxwell elements dissipate [J]. `kick`: time for which forces act [s]. Parallel over patches.
///
/// Let x_k be the position of node k of an element, and g_k the gradient of the shape function of this node at rest.
/// The deformation gradient of the element is F = sum_k (x_k - x_0) (x) g_k, with outer products (x). It determines the
/// first Piola-Kirchhoff stress P. With the rest volume V, the forces on the nodes are f_k = -V P g_k and
/// f_0 = -(f_1 + f_2 + ...).
///
/// - Sums run block by block and lane by lane, so that the bits do not depend on the number of workers.
/// - Laws with a corotational frame (the rotation nearest to F) start the search for it from `rotation` and write it to
///   next.rotation; other laws write no frame.
/// - For bodies that are left out (is_left_out()), `patches.force` stays unchanged.
Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real kick, std::span<const ElementRotation> rotation,
                            const ElementMemory& next, const PatchForces& patches);

}  // namespace skerry
