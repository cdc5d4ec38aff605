// One row per material.
#pragma once

#include <array>
#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/options.h"
#include "components/orthotropic_moduli.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Material constants that the kernels use. They are computed once from the parameters that the user sets.
struct MaterialConstants {
    MaterialModel model;
    Real shear_modulus;  // Lame constant mu at small strain [Pa]
    Real lame_lambda;    // Lame constant lambda at small strain [Pa]
    Real density;        // [kg/m^3]
    // loss factor of the material, nearly independent of the frequency (systems/material/relaxation.h)
    Real loss_factor = 0;
    Real bulk_viscosity = 0;  // damping ratio of volume changes, at the highest frequency of an element
    // Terms of the law of Ogden. `share`: fraction of the shear modulus that the term contributes; 0: the term is
    // unused. `exponent`: exponent of the stretches.
    std::array<Real, 3> share{1, 0, 0}, exponent{2, 2, 2};
    // Six symmetric matrices M_k of the law `orthotropic`, each with the entries xx, yy, zz, xy, yz, zx; initially
    // those of an isotropic material. With mu = shear_modulus and lambda = lame_lambda, the stiffness is
    // mu sum_k M_k (x) M_k + lambda I (x) I (systems/material/orthotropic.h).
    std::array<Real, 36> strain_modes = [] {
        constexpr Real root_two = 1.4142135623730951;
        std::array<Real, 36> modes{};
        for (std::size_t i = 0; i < 6; ++i) modes[7 * i] = i < 3 ? root_two : 1;
        return modes;
    }();

    // `yield_stress`: von Mises stress at which the material first yields; 0: it never yields. `hardening`: increase of
    // this stress per plastic strain [Pa].
    Real yield_stress = 0, hardening = 0;

    bool relaxes() const { return loss_factor > 0 || bulk_viscosity > 0; }
    bool yields() const { return yield_stress > 0; }
};
template <>
struct MembersOf<MaterialConstants> {
    static std::span<const Member> list();
};

/// Part of the stress that an element exerts.
/// - whole: the complete stress
/// - shear, volume: the part due to the Lame constant mu or lambda (part_of)
/// - guard: the stress of the inversion barrier, which keeps a tetrahedron from inverting; only tetrahedra have one
enum class ElementPart : std::uint8_t { whole, shear, volume, guard };
template <>
inline constexpr std::uint64_t value_count<ElementPart> = 4;

/// Ratio of the modulus of the inversion barrier to the modulus lambda + 2 mu of the material.
inline constexpr Real guard_modulus = 5;

/// Material constants for one part of the stress: those of the material with one Lame constant, while the other one is
/// zero. A material that yields is divided differently. The constants of an inversion barrier include no damping.
inline MaterialConstants part_of(MaterialConstants material, ElementPart part) {
    if (part == ElementPart::guard)
        return {.model = MaterialModel::guard,
                .shear_modulus = 0,
                .lame_lambda = guard_modulus * (material.lame_lambda + 2 * material.shear_modulus),
                .density = material.density};
    // In a material that yields, the part `volume` has the complete bulk modulus lambda + 2/3 mu, and `shear` has none.
    // With lambda = 0, `shear` would resist changes of volume, and so hinder plastic flow, which keeps the volume
    // (volumetric locking).
    const Real volume_of_shear = material.yields() ? -2.0 / 3 * material.shear_modulus : 0;
    if (part == ElementPart::shear) material.lame_lambda = volume_of_shear;
    if (part == ElementPart::volume) {
        material.lame_lambda -= volume_of_shear;
        material.shear_modulus = 0;
    }
    return material;
}

/// Surface properties of a material, body or collider. A negative property is replaced:
/// - body: by the property of its material
/// - collider: by the property of its material or, without a material, by that of the touching body
struct SurfaceProperties {
    Real static_friction = -1;
    Real dynamic_friction = -1;
    Real restitution = -1;

    bool operator==(const SurfaceProperties&) const = default;
};
template <>
struct NumbersOf<SurfaceProperties> : Reals<3> {};
template <>
struct NumbersOf<OrthotropicModuli> : Reals<15> {};

struct MaterialTable {
    Column<MaterialConstants> constants;
    Column<SurfaceProperties> surface;
    Column<Real> young_modulus;  // [Pa]
    Column<Real> poisson_ratio;
    Column<OrthotropicModuli> orthotropic;  // used by the law `orthotropic`
    // decay rate of velocities relative to the rigid motion of the body, or of all velocities if nodes of the body are
    // pinned [1/s]
    Column<Real> damping;
    Column<std::uint8_t> sets_losses;  // 1 if the user has set a loss factor above 0
    Column<std::uint32_t> slot;        // handle slot

    void for_each_column(auto&& visit) {
        visit("constants", constants, ColumnRole::state);
        visit("surface", surface, ColumnRole::state);
        visit("young_modulus", young_modulus, ColumnRole::state);
        visit("poisson_ratio", poisson_ratio, ColumnRole::state);
        visit("orthotropic", orthotropic, ColumnRole::state);
        visit("damping", damping, ColumnRole::state);
        visit("sets_losses", sets_losses, ColumnRole::state);
        visit("slot", slot, ColumnRole::state);
    }
};

}  // namespace skerry
