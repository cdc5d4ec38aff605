// Rows of contacts of rigid cylinders.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_touches.h"
#include "systems/collision/cylinders/rigid_cylinder.h"

namespace skerry {

/// A pair with a cylinder. If both are cylinders, `cylinder` is the one whose middle is the point of the candidates.
struct CylinderPair {
    std::uint64_t key;
    PairKind kind;
    Index cylinder;  // row of BodyTable
    Index other;     // row of BodyTable, or of ColliderTable

    CylinderPair(const CollisionInputs& inputs, const PairTable& pairs, Index p);

    Index body() const { return kind == PairKind::collider ? no_index : other; }
};

bool has_cylinder(const CollisionInputs& inputs, const PairTable& pairs, Index p);

// Touches of one candidate are numbered from 0. Numbers are below the first constant for a triangle and below the
// second for a shape; the upper half of the latter is for crossings.
inline constexpr Index touches_of_triangle = 64, touches_of_shape = 2 * CylinderTouches::most;

/// One touch of a cylinder, which is the first partner. `distance`: of the surfaces; `shell`: kept between them [m].
struct CylinderRow {
    std::uint64_t feature;  // of the candidate
    Index number;
    Stencil stencil;
    Vec3 point, normal;  // point on the other partner, in the world [m]; unit normal towards the cylinder
    Real distance, shell;
    Vec3 surface_velocity = Vec3::Zero();
};
ContactRow contact_row(const CollisionInputs& inputs, const CylinderPair& pair, const CylinderRow& row,
                       const SurfaceProperties& surface);

/// Stencil of the middle of a cylinder and up to three nodes of the other body, with the weights of the touched place.
Stencil stencil_of_cylinder(Index middle, const std::array<Index, 3>& node, const std::array<Real, 3>& weight);

}  // namespace skerry
