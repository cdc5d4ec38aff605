// Rows of contacts of rigid cylinders.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_touches.h"
#include "systems/collision/cylinders/rigid_cylinder.h"

namespace skerry {

/// A pair of which a cylinder is looked at against the other: of two the one whose middle is the point of candidates.
struct CylinderPair {
    std::uint64_t key;
    PairKind kind;
    Index cylinder;  // row of BodyTable
    Index other;     // row of BodyTable, or of ColliderTable

    CylinderPair(const CollisionInputs& inputs, const PairTable& pairs, Index p);

    Index body() const { return kind == PairKind::collider ? no_index : other; }
};

bool has_cylinder(const CollisionInputs& inputs, const PairTable& pairs, Index p);

// Touches of one candidate have numbers from 0: with a triangle below the first, else below the second, of which the
// upper half is of crossings.
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 2 * CylinderTouches::most;

/// The cylinder is the first partner. `place`: of the touch in the world; `distance`: of the surfaces.
struct CylinderRow {
    std::uint64_t feature;  // of the candidate
    Index number;
    Stencil stencil;
    Vec3 point, normal;  // m, on the other; unit, to the cylinder
    Real distance, shell;
    Vec3 surface_velocity = Vec3::Zero();
};
ContactRow contact_row(const CollisionInputs& inputs, const CylinderPair& pair, const CylinderRow& row,
                       const SurfaceProperties& surface);

/// Of the middle of a cylinder and up to three nodes of the other, with the weights of its place.
Stencil stencil_of_cylinder(Index middle, const std::array<Index, 3>& node, const std::array<Real, 3>& weight);

}  // namespace skerry
