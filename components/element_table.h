// Tetrahedra of the meshes, and the elements that give forces: both in blocks of element_lanes, each of one body.
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
using ElementGradient = std::array<ElementLane, 3>;  // 1/m, component i of lane l: gradient[i][l]
using ElementRotation = std::array<ElementLane, 4>;  // unit quaternion w, x, y, z
using ElementForm = std::array<ElementLane, 6>;      // symmetric: xx, yy, zz, xy, yz, zx
using FrameMass = std::array<ElementLane, 2>;        // q, 1/(kg m^2), and b, kg m^2 (frame_masses.h)
// Of a symmetric strain: xx, yy, zz, xy, yz, zx; then a volume strain of its own
using ElementStrain = std::array<ElementLane, 7>;

/// What the mesh is made of, in its order. Lanes that are left over repeat the body's first node with volume zero.
/// Tetrahedron t of the table is lane t % element_lanes of block t / element_lanes.
struct TetrahedronBlockTable {
    Column<TetrahedronNodes> node;
    Column<ElementLane> volume;    // m^3, at rest; 0 in a lane that is left over
    Column<ElementLane> altitude;  // m, the smallest at rest; infinite in a lane that is left over
    // in how many times max_strain_step F may change: more than 1 where an implicit element covers the tetrahedron
    Column<ElementLane> leeway;
    Column<std::uint8_t> sliver;  // bit l: tetrahedron of lane l is one (element_list.h)
    // m: none of the block turns inside out, or back, while the body's travel is below this
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

/// An element has four nodes or more, one F = sum_k x_k (x) g_k, which is constant in it, and one stress
/// (docs/methods/elasticity.md 1, 7). A block has a row of ElementNodeTable for every node of that of its elements
/// which has most; the others repeat their first node with a gradient of zero. Lanes that are left over have volume and
/// gradients zero and repeat the first node of the block, so that they add nothing. Element e of the table is lane e %
/// element_lanes of block e / element_lanes.
struct ElementBlockTable {
    Column<Index> first;             // row of ElementNodeTable
    Column<Index> count;             // of rows
    Column<ElementLane> volume;      // m^3, at rest; 0 in a lane that is left over, and of a guard that does not act
    Column<ElementLane> mass_share;  // weight with which an element takes mass from its nodes (stable_step.h)
    // 1/(kg m^2), Q of the mass G Q^-1 G^T that an element takes from its nodes (mass_forms.h); 0: it goes by
    // mass_share
    Column<ElementForm> mass_form;
    // what an element takes in a body that turns as a whole, and 1/s^2, the bound of omega^2 by it at rest; 0: the body
    // has no such masses
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound;
    Column<ElementLane> implicit_modulus;   // Pa, stiffness of an element that a cluster carries; 0: an explicit one
    Column<ElementRotation> rotation;       // corotational frame, the start of the next extraction
    Column<ElementRotation> rotation_next;  // this step's frame; swapped with rotation when the step is committed
    // Twice the Green strain that the relaxing part of the stress has forgotten, and twice the volume strain that the
    // bulk viscosity has; 0 where nothing is viscous (systems/material/relaxation.h)
    Column<ElementStrain> viscous_strain;
    // Of this step; swapped when the step is committed, so that between steps it is that of before the last one.
    Column<ElementStrain> viscous_strain_next;
    Column<ElementLane> relaxation_rate;  // 1/s, how fast the relaxing part forgets
    Column<ElementLane> own_frequency;    // 1/s, highest of the element at rest, from above
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

/// Numbers in a row of a patch.
inline constexpr Index slot_width = sizeof(PaddedVec3) / sizeof(Real);

/// The k-th nodes of the elements of a block, k = 0 first: the one whose gradient is minus the sum of all others.
struct ElementNodeTable {
    Column<NodeLane> node;
    Column<NodeLane> slot;             // where the node's row of a patch begins, in numbers: slot_width times its place
    Column<ElementGradient> gradient;  // at rest

    /// The only list of columns: resize, erase, hash and save walk it. Derived: slot by build_patches.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("gradient", gradient, ColumnRole::state);
        visit("slot", slot, ColumnRole::derived);
    }
};

/// J per unit of the rate of F, column by column: what the viscosity of an element does in a step.
using ElementViscousImpulse = std::array<ElementLane, 9>;

/// Patches: blocks of one body that lie close together, so that they have few nodes between them. Forces are summed up
/// within a patch, in cache, before nodes gather what few patches give them. Made from the blocks by
/// build_patches, body after body: the lists grow and nothing points to them.
struct ElementPatches {
    Column<Range> blocks;         // of ElementBlockTable, by patch
    Column<Range> slots;          // rows of the columns below, by patch
    Column<Index> node;           // by slot: row of NodeTable
    Ragged<Index> slots_of_node;  // by node, ascending
    Column<PaddedVec3> position;  // m, by slot; scratch
    Column<PaddedVec3> force;     // force of the patch on the node, by slot [N]; scratch
    Column<Real> relaxed;         // energy that relaxed in the elements of a patch in this step [J]; scratch
    // by block, of those that are viscous in this step; no rows if no block is viscous; scratch
    Column<ElementViscousImpulse> viscous_impulse;
    Column<std::uint8_t> viscous;  // by block: whether it has one in this step; as many rows; scratch
    // by block: whether an implicit element of it comes near the stiffness that it is taken to have; as many; scratch
    Column<std::uint8_t> stiffening;

    /// Room for what is viscous.
    void resize_viscous(std::size_t count) {
        viscous_impulse.resize(count);
        viscous.resize(count);
        stiffening.resize(count);
    }
};

/// The rows of ElementNodeTable that a block of elements has. `node`: where its nodes are in the list of positions that
/// goes with it.
struct BlockNodes {
    const NodeLane* node;
    const ElementGradient* gradient;
    Index count;
};

}  // namespace skerry
