// Tetrahedra of the meshes, and the elements that exert forces. Both are stored in blocks of element_lanes lanes; each
// block belongs to one body.
#pragma once

#include <array>
#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/lanes.h"
#include "components/material_table.h"
#include "components/ragged.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

using ElementLane = Lanes<Real, element_lanes>;
using NodeLane = Lanes<Index, element_lanes>;        // rows of NodeTable
using TetrahedronNodes = std::array<NodeLane, 4>;    // corner a of lane l is nodes[a][l]
using ElementGradient = std::array<ElementLane, 3>;  // component i of lane l is gradient[i][l] [1/m]
using ElementRotation = std::array<ElementLane, 4>;  // unit quaternion w, x, y, z
using ElementForm = std::array<ElementLane, 6>;      // symmetric matrix: xx, yy, zz, xy, yz, zx
using FrameMass = std::array<ElementLane, 2>;        // coefficients q [1/(kg m^2)] and b [kg m^2] of frame_masses.h
// Symmetric strain xx, yy, zz, xy, yz, zx, followed by a separate volume strain.
using ElementStrain = std::array<ElementLane, 7>;

/// The tetrahedra of the meshes, in mesh order. Unused lanes repeat the first node of the body and have volume zero.
/// Tetrahedron t of the table is lane t % element_lanes of block t / element_lanes.
struct TetrahedronBlockTable {
    Column<TetrahedronNodes> node;
    Column<ElementLane> volume;    // volume at rest; 0 in an unused lane [m^3]
    Column<ElementLane> altitude;  // smallest altitude at rest; infinite in an unused lane [m]
    // Factor on max_strain_step, the change of the deformation gradient F allowed in a step. It is above 1 if an
    // implicit element covers the tetrahedron.
    Column<ElementLane> leeway;
    Column<std::uint8_t> sliver;  // bit l: the tetrahedron of lane l is a sliver (element_list.h)
    // No tetrahedron of the block changes the sign of its volume while BodyTable::travel is below this [m].
    Column<Real> uninverted_until;

    /// Visits all columns. This is the only list of them: resize, erase, hash and save use it.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("volume", volume, ColumnRole::state);
        visit("altitude", altitude, ColumnRole::state);
        visit("leeway", leeway, ColumnRole::state);
        visit("sliver", sliver, ColumnRole::state);
        visit("uninverted_until", uninverted_until, ColumnRole::memory);
    }
};

/// An element has four nodes or more, one stress, and one deformation gradient F = sum_k x_k (x) g_k with node
/// positions x_k and gradients g_k (docs/methods/elasticity.md 1, 7). A block has as many rows of ElementNodeTable as
/// its element with the most nodes. Elements with fewer nodes repeat their first node with gradient zero. Unused lanes
/// add nothing: their volume and gradients are zero, and they repeat the first node of the block. Element e of the
/// table is lane e % element_lanes of block e / element_lanes.
struct ElementBlockTable {
    Column<Index> first;             // row of ElementNodeTable
    Column<Index> count;             // number of rows
    Column<ElementLane> volume;      // volume at rest; 0 in an unused lane and for an inactive inversion barrier [m^3]
    Column<ElementLane> mass_share;  // weight of the element where elements share the mass of a node (stable_step.h)
    // Matrix Q that defines the mass G Q^-1 G^T assigned to the element, part of the mass of its nodes, with its
    // gradients G (mass_forms.h) [1/(kg m^2)]. 0: mass_share is used instead.
    Column<ElementForm> mass_form;
    // Coefficients of the mass assigned to the element in a body that rotates as a whole (frame_masses.h). The masses
    // give the bound `frame_bound` of the squared highest frequency omega^2 at rest [1/s^2]. 0: the body has no such
    // masses.
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound;
    // Assumed stiffness of an implicit element, which belongs to a cluster; 0: explicit element [Pa].
    Column<ElementLane> implicit_modulus;
    Column<ElementRotation> rotation;  // corotational frame; initial guess when the next rotation is extracted
    // Corotational frame of this step; swapped with `rotation` when the step is committed.
    Column<ElementRotation> rotation_next;
    // Strain of the dashpots (systems/material/relaxation.h): twice the Green strain of the relaxing part of the
    // stress, and twice the volume strain of the bulk viscosity. 0 without viscosity.
    Column<ElementStrain> viscous_strain;
    // Strain of the dashpots at the end of this step. It is swapped with viscous_strain when the step is committed, so
    // that between steps it is the strain before the last step.
    Column<ElementStrain> viscous_strain_next;
    Column<ElementLane> relaxation_rate;  // relaxation rate of the relaxing part of the stress [1/s]
    Column<ElementLane> own_frequency;    // upper bound of the highest frequency of the element at rest [1/s]
    Column<Real> relaxing_share;          // ratio of the stiffness of the relaxing part to the stiffness of the law
    Column<Index> body;                   // row of BodyTable
    Column<Index> material;               // row of MaterialTable
    Column<ElementPart> part;
    Column<std::uint8_t> opens_patch;  // 1: the block is the first of a patch
    // Ratio of viscosity to modulus of the implicit elements of the block [s]; 0 without implicit elements.
    Column<Real> viscous_time;

    /// Visits all columns. This is the only list of them: resize, erase, hash and save use it.
    void for_each_column(auto&& visit) {
        visit("first", first, ColumnRole::link);
        visit("count", count, ColumnRole::state);
        visit("volume", volume, ColumnRole::state);
        visit("mass_share", mass_share, ColumnRole::state);
        visit("mass_form", mass_form, ColumnRole::state);
        visit("frame_mass", frame_mass, ColumnRole::state);
        visit("frame_bound", frame_bound, ColumnRole::state);
        visit("implicit_modulus", implicit_modulus, ColumnRole::state);
        visit("rotation", rotation, ColumnRole::state);
        visit("body", body, ColumnRole::link);
        visit("material", material, ColumnRole::link);
        visit("part", part, ColumnRole::state);
        visit("opens_patch", opens_patch, ColumnRole::state);
        visit("viscous_time", viscous_time, ColumnRole::state);
        visit("viscous_strain", viscous_strain, ColumnRole::state);
        visit("relaxation_rate", relaxation_rate, ColumnRole::state);
        visit("own_frequency", own_frequency, ColumnRole::state);
        visit("relaxing_share", relaxing_share, ColumnRole::state);
        visit("viscous_strain_next", viscous_strain_next, ColumnRole::memory);
        visit("rotation_next", rotation_next, ColumnRole::scratch);
    }
};

/// Vector x, y, z padded with a zero, so that it fills a register.
using PaddedVec3 = Lanes<Real, 4>;

/// Number of reals per row of a patch.
inline constexpr Index slot_width = sizeof(PaddedVec3) / sizeof(Real);

/// Nodes of the elements of a block. Row k of a block, counted from 0, holds the k-th node of each element. The
/// gradient of node 0 is minus the sum of all other gradients.
struct ElementNodeTable {
    Column<NodeLane> node;
    Column<NodeLane> slot;             // offset of the node's row in its patch: slot_width times its slot [reals]
    Column<ElementGradient> gradient;  // at rest

    /// Visits all columns. This is the only list of them: resize, erase, hash and save use it. build_patches derives
    /// `slot`.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("gradient", gradient, ColumnRole::state);
        visit("slot", slot, ColumnRole::derived);
    }
};

/// Viscous impulse of an element in a step: volume times viscous stress times duration, column by column [J s].
using ElementViscousImpulse = std::array<ElementLane, 9>;

/// Patches: groups of neighbouring blocks of one body. Forces are summed within a patch, in cache, before each node
/// adds up the results of its few patches. build_patches makes the patches from the blocks, body after body, and
/// appends them to the lists. No other table refers to rows of the lists.
struct ElementPatches {
    Column<Range> blocks;         // by patch: rows of ElementBlockTable
    Column<Range> slots;          // by patch: its slots, which are rows of the columns below
    Column<Index> node;           // by slot: row of NodeTable
    Ragged<Index> slots_of_node;  // by node: its slots, ascending
    Column<PaddedVec3> position;  // by slot: position of the node [m]; scratch
    Column<PaddedVec3> force;     // by slot: force of the patch on the node [N]; scratch
    Column<Real> relaxed;         // by patch: energy that its elements lost by relaxation in this step [J]; scratch
    // Viscous impulse by block, set if the block is viscous in this step. No rows if no block can be viscous. Scratch.
    Column<ElementViscousImpulse> viscous_impulse;
    Column<std::uint8_t> viscous;  // by block: 1 if it is viscous in this step; same rows as viscous_impulse; scratch
    // Flag by block: 1 if the stiffness of an implicit element comes near its implicit_modulus. Rows as in
    // viscous_impulse. Scratch.
    Column<std::uint8_t> stiffening;

    /// Resizes the columns of viscous quantities to `count` blocks.
    void resize_viscous(std::size_t count) {
        viscous_impulse.resize(count);
        viscous.resize(count);
        stiffening.resize(count);
    }
};

/// Rows of ElementNodeTable of one block of elements. `node`: index of each node in the array of positions that is used
/// with the rows.
struct BlockNodes {
    const NodeLane* node;
    const ElementGradient* gradient;
    Index count;
};

}  // namespace skerry
