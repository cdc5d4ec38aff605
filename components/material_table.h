// One row per material.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/options.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// What a kernel needs of a material, derived once.
struct MaterialConstants {
    MaterialModel model;
    Real shear_modulus;       // Pa, Lame mu of small strain
    Real lame_lambda;         // Pa, Lame lambda of small strain
    Real density;             // kg/m^3
    Real loss_factor = 0;     // systems/material/relaxation.h
    Real bulk_viscosity = 0;  // damping ratio of an element's own highest frequency, by its change of volume

    bool relaxes() const { return loss_factor > 0 || bulk_viscosity > 0; }
};
template <>
struct MembersOf<MaterialConstants> {
    static std::span<const Member> list();
};

/// Which part of the stress an element gives: all of it, what goes with one of Lame's constants alone, or what keeps a
/// tetrahedron from turning over, which no other element has.
enum class ElementPart : std::uint8_t { whole, shear, volume, guard };
template <>
inline constexpr std::uint64_t value_count<ElementPart> = 4;

/// Pa, of the law of guards, over the modulus lambda + 2 mu of the material.
inline constexpr Real guard_modulus = 5;

/// What goes with one of Lame's constants alone: the other is zero. A guard loses nothing, but for its viscosity where
/// a cluster carries it.
inline MaterialConstants part_of(MaterialConstants material, ElementPart part) {
    if (part == ElementPart::guard)
        return {.model = MaterialModel::guard,
                .shear_modulus = 0,
                .lame_lambda = guard_modulus * (material.lame_lambda + 2 * material.shear_modulus),
                .density = material.density};
    if (part == ElementPart::shear) material.lame_lambda = 0;
    if (part == ElementPart::volume) material.shear_modulus = 0;
    return material;
}

/// What a contact needs of a surface. What is below zero is left to others: of a body to its material, of a collider to
/// the body.
struct SurfaceProperties {
    Real static_friction = -1;
    Real dynamic_friction = -1;
    Real restitution = -1;

    bool operator==(const SurfaceProperties&) const = default;
};
template <>
struct NumbersOf<SurfaceProperties> : Reals<3> {};

struct MaterialTable {
    Column<MaterialConstants> constants;
    Column<SurfaceProperties> surface;
    Column<Real> young_modulus;  // Pa
    Column<Real> poisson_ratio;
    Column<Real> damping;        // 1/s, rate at which deformation velocities decay; rigid motion is kept
    Column<std::uint32_t> slot;  // handle slot

    void for_each_column(auto&& visit) {
        visit("constants", constants, ColumnRole::state);
        visit("surface", surface, ColumnRole::state);
        visit("young_modulus", young_modulus, ColumnRole::state);
        visit("poisson_ratio", poisson_ratio, ColumnRole::state);
        visit("damping", damping, ColumnRole::state);
        visit("slot", slot, ColumnRole::state);
    }
};

}  // namespace skerry
