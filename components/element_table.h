// Tetrahedra of the meshes, and the elements that give forces. Both are stored in blocks of element_lanes, each of one
// body.
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
using TetrahedronNodes = std::array<NodeLane, 4>;    // corner a of lane l: nodes[a][l]
using ElementGradient = std::array<ElementLane, 3>;  // component i of lane l: gradient[i][l] [1/m]
using ElementRotation = std::array<ElementLane, 4>;  // unit quaternion w, x, y, z
using ElementForm = std::array<ElementLane, 6>;      // symmetric: xx, yy, zz, xy, yz, zx
using FrameMass = std::array<ElementLane, 2>;        // q [1/(kg m^2)] and b [kg m^2] (frame_masses.h)
// Symmetric strain xx, yy, zz, xy, yz, zx, followed by a separate volume strain.
using ElementStrain = std::array<ElementLane, 7>;

/// The tetrahedra of the meshes, in mesh order. Unused lanes repeat the body's first node with volume zero. Tetrahedron
/// t of the table is lane t % element_lanes of block t / element_lanes.
struct TetrahedronBlockTable {
    Column<TetrahedronNodes> node;
    Column<ElementLane> volume;    // at rest; 0 in an unused lane [m^3]
    Column<ElementLane> altitude;  // the smallest at rest; infinite in an unused lane [m]
    // Change of F allowed per step, in multiples of max_strain_step; above 1 if an implicit element covers the
    // tetrahedron.
    Column<ElementLane> leeway;
    Column<std::uint8_t> sliver;  // bit l: the tetrahedron of lane l is a sliver (element_list.h)
    // No tetrahedron of the block turns inside out or back while the body's travel is below this [m].
    Column<Real> uninverted_until;

    /// The only list of columns: resize, erase, hash and save walk it.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("volume", volume, ColumnRole::state);
        visit("altitude", altitude, ColumnRole::state);
        visit("leeway", leeway, ColumnRole::state);
        visit("sliver", sliver, ColumnRole::state);
        visit("uninverted_until", uninverted_until, ColumnRole::memory);
    }
};

/// An element has four nodes or more, one F = sum_k x_k (x) g_k, constant in the element, and one stress
/// (docs/methods/elasticity.md 1, 7). A block has as many rows of ElementNodeTable as its element with most nodes;
/// elements with fewer nodes repeat their first node with gradient zero. Unused lanes have volume and gradients zero
/// and repeat the first node of the block, so that they add nothing. Element e of the table is lane e % element_lanes
/// of block e / element_lanes.
struct ElementBlockTable {
    Column<Index> first;             // row of ElementNodeTable
    Column<Index> count;             // number of rows
    Column<ElementLane> volume;      // at rest; 0 in an unused lane and for an inactive inversion barrier [m^3]
    Column<ElementLane> mass_share;  // weight with which an element takes mass from its nodes (stable_step.h)
    // Q of the mass G Q^-1 G^T that an element takes from its nodes (mass_forms.h) [1/(kg m^2)]; 0: mass_share is used
    // instead
    Column<ElementForm> mass_form;
    // Mass that an element takes from its nodes in a body that turns as a whole, and the resulting bound of omega^2 at
    // rest [1/s^2]. 0: the body has no such masses
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound;
    Column<ElementLane> implicit_modulus;   // stiffness of an element in a cluster; 0: explicit element [Pa]
    Column<ElementRotation> rotation;       // corotational frame, the initial guess of the next extraction
    Column<ElementRotation> rotation_next;  // this step's frame; swapped with rotation when the step is committed
    // Twice the viscous Green strain of the relaxing part of the stress, and twice the viscous volume strain of the
    // bulk viscosity; 0 without viscosity (systems/material/relaxation.h)
    Column<ElementStrain> viscous_strain;
    // Viscous strain of this step. Swapped when the step is committed: between steps it holds the value before the last
    // step.
    Column<ElementStrain> viscous_strain_next;
    Column<ElementLane> relaxation_rate;  // rate at which the relaxing part relaxes [1/s]
    Column<ElementLane> own_frequency;    // upper bound of the highest frequency of the element at rest [1/s]
    Column<Real> relaxing_share;          // stiffness of the relaxing part over that of the law at rest
    Column<Index> body;                   // row of BodyTable
    Column<Index> material;               // row of MaterialTable
    Column<ElementPart> part;
    Column<std::uint8_t> opens_patch;  // 1: the block is the first of a patch
    // viscosity over modulus of the implicit elements of the block [s]; 0 if it has none
    Column<Real> viscous_time;

    /// The only list of columns: resize, erase, hash and save walk it.
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

/// x, y, z and a zero: one register.
using PaddedVec3 = Lanes<Real, 4>;

/// Numbers per row of a patch.
inline constexpr Index slot_width = sizeof(PaddedVec3) / sizeof(Real);

/// The k-th nodes of the elements of a block, k = 0 first. The gradient of node 0 is minus the sum of all others.
struct ElementNodeTable {
    Column<NodeLane> node;
    Column<NodeLane> slot;             // offset of the node's row in its patch: slot_width times its place [numbers]
    Column<ElementGradient> gradient;  // at rest

    /// The only list of columns: resize, erase, hash and save walk it. Derived: slot by build_patches.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("gradient", gradient, ColumnRole::state);
        visit("slot", slot, ColumnRole::derived);
    }
};

/// Viscous impulse of an element in a step, column by column [J per unit of the rate of F].
using ElementViscousImpulse = std::array<ElementLane, 9>;

/// Patches: blocks of one body that lie close together and share few nodes. Forces are summed within a patch, in cache,
/// before nodes gather the results of their few patches. Made from the blocks by build_patches, body after body: the
/// lists grow and nothing points to them.
struct ElementPatches {
    Column<Range> blocks;         // of ElementBlockTable, by patch
    Column<Range> slots;          // rows of the columns below, by patch
    Column<Index> node;           // by slot: row of NodeTable
    Ragged<Index> slots_of_node;  // by node, ascending
    Column<PaddedVec3> position;  // by slot; scratch [m]
    Column<PaddedVec3> force;     // force of the patch on the node, by slot [N]; scratch
    Column<Real> relaxed;         // energy that relaxed in the elements of a patch in this step [J]; scratch
    // Per block: viscous impulse, set if it is viscous in this step; no rows if no block is viscous; scratch.
    Column<ElementViscousImpulse> viscous_impulse;
    Column<std::uint8_t> viscous;  // by block: whether it is viscous in this step; as many rows; scratch
    // Per block: whether the stiffness of an implicit element comes near its assumed modulus; as many rows; scratch.
    Column<std::uint8_t> stiffening;

    /// Resizes the viscous columns to `count` blocks.
    void resize_viscous(std::size_t count) {
        viscous_impulse.resize(count);
        viscous.resize(count);
        stiffening.resize(count);
    }
};

/// The rows of ElementNodeTable of one block of elements. `node`: indices of its nodes in the list of positions used
/// with it.
struct BlockNodes {
    const NodeLane* node;
    const ElementGradient* gradient;
    Index count;
};

}  // namespace skerry
