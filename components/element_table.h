// One row per block of element_lanes tetrahedra of one body.
#pragma once

#include <array>
#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/lanes.h"
#include "components/types.h"

namespace skerry {

using ElementLane = Lanes<Real, element_lanes>;
using ElementNodes = std::array<Lanes<Index, element_lanes>, 4>;  // corner a of lane l: nodes[a][l]
// B = Dm^-1, column-major: B(i, j) = rest[3 j + i]
using ElementRest = std::array<ElementLane, 9>;
using ElementRotation = std::array<ElementLane, 4>;  // unit quaternion w, x, y, z
// Of a symmetric strain: xx, yy, zz, xy, yz, zx; then a volume strain of its own
using ElementStrain = std::array<ElementLane, 7>;
using ElementForces = std::array<std::array<Vec3, 4>, element_lanes>;  // N, of lane l on its corner a: forces[l][a]

/// Tetrahedra, element_lanes side by side. A block belongs to one body; lanes that are left over repeat the body's
/// first node with volume and B zero, so that they add nothing. Element e of the table is lane e % element_lanes of
/// block e / element_lanes.
struct ElementBlockTable {
    Column<ElementNodes> node;              // rows of NodeTable
    Column<ElementRest> inverse_rest;       // 1/m
    Column<ElementLane> volume;             // m^3, at rest; 0 in a lane that is left over
    Column<ElementRotation> rotation;       // corotational frame, the start of the next extraction
    Column<ElementRotation> rotation_next;  // this step's frame; swapped with rotation when the step is committed
    // Green strain that the relaxing part of the stress has forgotten, and the volume strain that the bulk viscosity
    // has; 0 where nothing is viscous (systems/material/relaxation.h)
    Column<ElementStrain> viscous_strain;
    Column<ElementStrain> viscous_strain_next;  // of this step; swapped when the step is committed
    Column<ElementLane> relaxation_rate;        // 1/s, how fast the relaxing part forgets
    Column<ElementLane> own_frequency;          // 1/s, highest of the element at rest, from above
    Column<Real> relaxing_share;                // stiffness of the relaxing part over that of the law at rest
    Column<ElementForces> force;                // N
    Column<Real> relaxed;                       // J, what the block dissipated in this step
    Column<Index> body;                         // row of BodyTable
    Column<Index> material;                     // row of MaterialTable
    // s, stress of the strain rate over that of the strain; 0 but for fine elements among coarse
    Column<Real> viscous_time;
    // m: no element of the block turns inside out, or back, while the body's travel is below this
    Column<Real> uninverted_until;
    // within the body: impulses come every 2^level of the body's steps (step_levels.h)
    Column<std::uint8_t> level;

    /// The only list of columns: resize, erase, copy and hash walk it. Derived: uninverted_until by
    /// ContactCache::forget_distances.
    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::link);
        visit("inverse_rest", inverse_rest, ColumnRole::state);
        visit("volume", volume, ColumnRole::state);
        visit("rotation", rotation, ColumnRole::state);
        visit("body", body, ColumnRole::link);
        visit("material", material, ColumnRole::link);
        visit("viscous_time", viscous_time, ColumnRole::state);
        visit("level", level, ColumnRole::state);
        visit("viscous_strain", viscous_strain, ColumnRole::state);
        visit("relaxation_rate", relaxation_rate, ColumnRole::state);
        visit("own_frequency", own_frequency, ColumnRole::state);
        visit("relaxing_share", relaxing_share, ColumnRole::state);
        visit("viscous_strain_next", viscous_strain_next, ColumnRole::scratch);
        visit("relaxed", relaxed, ColumnRole::scratch);
        visit("rotation_next", rotation_next, ColumnRole::scratch);
        visit("uninverted_until", uninverted_until, ColumnRole::derived);
        visit("force", force, ColumnRole::scratch);
    }
};

}  // namespace skerry
