// Tetrahedra of the meshes, and the elements that exert forces. Tetrahedra and elements are stored in blocks of
// element_lanes lanes. Each block belongs to one body.
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
// Coefficients q [1/(kg m^2)] and b [kg m^2] of the mass form of an element (docs/methods/stable_step.md 2.4). Node
// displacements with the gradient X have the mass form |X|^2/q + b (R:X)^2, where R is the rotation of the body. A
// bound on the stable step uses it (frame_masses.h).
using FrameMass = std::array<ElementLane, 2>;

/// Number of Maxwell elements (a spring in series with a dashpot) that act in parallel with the material law of each
/// element (docs/methods/elasticity.md 6).
inline constexpr std::size_t maxwell_count = 3;
// Relaxation rates of the Maxwell elements of a body, the highest first [1/s]
using RelaxationRates = std::array<Real, maxwell_count>;
// Twice the strains of an element at the last step, in single precision. The viscous stress of the present step depends
// on them.
// - entries 0 to 5: components xx, yy, zz, xy, yz, zx of twice Green's strain, F^T F - I
// - entries 6 to 23: springs of the Maxwell elements, six components each
// - entry 24: volume strain of the spring of the bulk viscosity
// - entry 25: unused; with it a block fills whole cache lines
using SpringStrain = std::array<Lanes<float, element_lanes>, 8 + 6 * maxwell_count>;
inline constexpr std::size_t bulk_entry = 6 + 6 * maxwell_count;  // entry of the spring of the bulk viscosity

/// The tetrahedra of the meshes, in mesh order. Unused lanes repeat the first node of the body and have zero volume.
/// Tetrahedron t of the table is lane t % element_lanes of block t / element_lanes.
struct TetrahedronBlockTable {
    Column<TetrahedronNodes> node;
    Column<ElementLane> volume;    // volume at rest; 0 in an unused lane [m^3]
    Column<ElementLane> altitude;  // smallest altitude at rest; infinite in an unused lane [m]
    // Factor on max_strain_step, the largest change of the deformation gradient that a step may make. It is above 1 for
    // a tetrahedron that belongs to an implicit element.
    Column<ElementLane> leeway;
    Column<std::uint8_t> sliver;  // bit l: the tetrahedron of lane l is a sliver (element_list.h)
    // No tetrahedron of the block changes the sign of its volume while BodyTable::travel is below this value [m].
    Column<Real> uninverted_until;

    /// Visits all columns. This is the only list of the columns; resizing, erasing, hashing and saving use it.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("volume", volume, ColumnRole::state);
        visit("altitude", altitude, ColumnRole::state);
        visit("leeway", leeway, ColumnRole::state);
        visit("sliver", sliver, ColumnRole::state);
        visit("uninverted_until", uninverted_until, ColumnRole::memory);
    }
};

/// Elements that exert forces. An element has at least four nodes k, with positions x_k and shape function gradients
/// g_k, one deformation gradient F = sum_k x_k (x) g_k, and one stress (docs/methods/elasticity.md 1, 7). Element e is
/// lane e % element_lanes of block e / element_lanes.
///
/// A block has as many rows of ElementNodeTable as the greatest node count of its elements. Elements with fewer nodes
/// repeat some of their nodes with zero gradient. Unused lanes have zero volume and gradients, and nodes of the first
/// element of the block.
struct ElementBlockTable {
    Column<Index> first;         // first row of the block in ElementNodeTable
    Column<Index> count;         // number of rows of the block in ElementNodeTable
    Column<ElementLane> volume;  // volume at rest [m^3]; 0 for an unused lane and for an inactive inversion barrier
    // For a bound on the stable step, the mass of each node is divided among its elements in proportion to these
    // weights (stable_step.h).
    Column<ElementLane> mass_share;
    // Symmetric matrix Q of the mass form of the element [1/(kg m^2)]. The form is the part G Q^-1 G^T of the mass
    // matrix of the nodes, where row k of G is the gradient of node k; it serves for a bound on the stable step
    // (mass_forms.h). Q = 0: mass_share is used instead.
    Column<ElementForm> mass_form;
    // Mass forms for a second bound on the stable step, with one rotation for the whole body
    // (docs/methods/stable_step.md 2.4). `frame_mass`: coefficients of the form of each element. `frame_bound`: upper
    // bound of omega^2 by these forms for the rest shape, with the highest circular frequency omega; 0: the body has no
    // such forms [1/s^2].
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound;
    // Stiffness that the implicit integration assumes for an element of a cluster; 0: the element is explicit [Pa].
    Column<ElementLane> implicit_modulus;
    // corotational frame at the last step; initial guess when the rotation is extracted again
    Column<ElementRotation> rotation;
    // Corotational frame in this step. The columns `rotation` and `rotation_next` are swapped when the step is
    // committed.
    Column<ElementRotation> rotation_next;
    // Strains of the springs of the Maxwell elements in the last step (systems/material/relaxation.h); 0 without losses
    Column<SpringStrain> spring_strain;
    // Strains of the springs in this step. The columns spring_strain and spring_strain_next are swapped when the step
    // is committed.
    Column<SpringStrain> spring_strain_next;
    Column<ElementLane> plastic_strain;       // equivalent plastic strain; 0 if the material does not yield
    Column<RelaxationRates> relaxation_rate;  // equal for all blocks of a body
    Column<ElementLane> own_frequency;        // upper bound of the circular frequencies of the element at rest [1/s]
    // stiffness of the spring of each Maxwell element, as a fraction of the stiffness of the material law
    Column<Real> relaxing_share;
    // Rotation from the axes of the mesh to the axes in which the gradients are stored. The axes of anisotropic
    // materials are given in the mesh and are rotated by it. turn_elements() rotates the gradients and updates this
    // matrix.
    Column<Mat3> orientation;
    Column<Index> body;      // row of BodyTable
    Column<Index> material;  // row of MaterialTable
    Column<ElementPart> part;
    Column<std::uint8_t> opens_patch;  // 1: the block is the first block of a patch (ElementPatches)
    // Ratio of viscosity to modulus of the implicit elements in the block; 0 without implicit elements [s].
    Column<Real> viscous_time;

    /// Visits all columns. This is the only list of the columns; resizing, erasing, hashing and saving use it.
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
        visit("orientation", orientation, ColumnRole::state);
        visit("body", body, ColumnRole::link);
        visit("material", material, ColumnRole::link);
        visit("part", part, ColumnRole::state);
        visit("opens_patch", opens_patch, ColumnRole::state);
        visit("viscous_time", viscous_time, ColumnRole::state);
        visit("spring_strain", spring_strain, ColumnRole::state);
        visit("plastic_strain", plastic_strain, ColumnRole::state);
        visit("relaxation_rate", relaxation_rate, ColumnRole::state);
        visit("own_frequency", own_frequency, ColumnRole::state);
        visit("relaxing_share", relaxing_share, ColumnRole::state);
        visit("spring_strain_next", spring_strain_next, ColumnRole::memory);
        visit("rotation_next", rotation_next, ColumnRole::scratch);
    }
};

/// Vector x, y, z. The fourth number is unused, so that the vector fills a register of 256 bits.
using PaddedVec3 = Lanes<Real, 4>;

/// Number of reals in a slot. A slot stores a vector of one node of a patch (ElementPatches) as a PaddedVec3.
inline constexpr Index slot_width = sizeof(PaddedVec3) / sizeof(Real);

/// Nodes of the elements of a block. Row k of a block holds the k-th node of each element, counted from 0. The gradient
/// of node 0 is minus the sum of the gradients of all other nodes.
struct ElementNodeTable {
    Column<NodeLane> node;
    // Place of the node in the columns by slot of ElementPatches, seen as arrays of reals that begin with the patch:
    // number of the node's slot within the patch, times slot_width.
    Column<NodeLane> slot;
    // shape function gradient of the node in the rest shape, which plastic flow changes [1/m]
    Column<ElementGradient> gradient;

    /// Visits all columns. This is the only list of the columns; resizing, erasing, hashing and saving use it.
    /// build_patches derives `slot`.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("gradient", gradient, ColumnRole::state);
        visit("slot", slot, ColumnRole::derived);
    }
};

/// Viscous impulse of an element in a step: element volume times viscous stress times step length [J s]. The nine
/// components of the stress are stored column by column.
using ElementViscousImpulse = std::array<ElementLane, 9>;

/// Patches: groups of neighbouring blocks of one body. Element forces are first summed within each patch, in cache;
/// then the force on a node is the sum over the few patches that contain it. build_patches appends the rows, body after
/// body. No other table refers to them.
struct ElementPatches {
    Column<Range> blocks;  // by patch: rows of ElementBlockTable
    // by patch: its slots (rows of the columns below that are listed by slot), one for each node of the patch
    Column<Range> slots;
    Column<Index> node;           // by slot: its node, a row of NodeTable
    Ragged<Index> slots_of_node;  // by node: its slots, ascending
    Column<PaddedVec3> position;  // by slot: position of the node [m]; scratch
    Column<PaddedVec3> force;     // by slot: sum of the forces of the patch on the node [N]; scratch
    // by patch: energy that the Maxwell elements in the patch dissipated in this step [J]; scratch
    Column<Real> relaxed;
    // Viscous impulse of the elements, by block. It is set only for viscous blocks. A block is viscous in this step if
    // it has an implicit element that is strongly strained. The column is empty if no block can be viscous. Scratch.
    Column<ElementViscousImpulse> viscous_impulse;
    // by block: 1 if the block is viscous in this step; empty if no block can be viscous; scratch
    Column<std::uint8_t> viscous;
    // Flag by block: 1 if stiffen_clusters must compute the stiffness of the implicit elements exactly, because the
    // stiffness of one of them has nearly reached its implicit_modulus. The column is empty if no block can be viscous.
    // Scratch.
    Column<std::uint8_t> stiffening;

    /// Resizes viscous_impulse, viscous and stiffening to `count` blocks.
    void resize_viscous(std::size_t count) {
        viscous_impulse.resize(count);
        viscous.resize(count);
        stiffening.resize(count);
    }
};

/// Rows of ElementNodeTable that belong to one block of elements. The entries of `node` are indices in an array of node
/// positions, which functions take as a further argument.
struct BlockNodes {
    const NodeLane* node;
    const ElementGradient* gradient;
    Index count;  // number of rows: the largest number of nodes of an element of the block

    /// Number of nodes of the element in a lane. Later rows are padding: they repeat nodes of this element.
    Index count_in_lane(std::size_t lane) const {
        for (Index k = 1; k < count; ++k)
            for (Index earlier = 0; earlier < k; ++earlier)
                if (node[k][lane] == node[earlier][lane]) return k;
        return count;
    }
};

}  // namespace skerry
