// Materials with values from the literature. The command `skerry materials` prints them.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "skerry/settings.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A number from the literature, with its source.
struct SourcedValue {
    Real value;               // value in the unit stated at the member of NamedMaterial
    std::string_view source;  // citation, and how the value was derived from the cited number
};

/// A material of named_materials(). Its values are typical; measure those that decide your result.
struct NamedMaterial {
    std::string_view name;       // identifier for named_material() and for the key "like" of scene files
    std::string_view title;      // description for people
    SourcedValue young_modulus;  // at small strain [Pa]
    SourcedValue poisson_ratio;  // 0.49 for rubber, gels and tissue, which are nearly incompressible
    SourcedValue density;        // [kg/m^3]
    // tangent of the phase angle between stress and strain; empty if not known
    std::optional<SourcedValue> loss_factor;
    // Plasticity::yield_stress [Pa], empty if not known; named_material() does not set it
    std::optional<SourcedValue> yield_stress{};
};

/// Friction coefficients of two clean, dry surfaces.
struct KnownFriction {
    std::string_view first, second;          // names of materials
    Real static_friction, dynamic_friction;  // coefficients
    std::string_view source;                 // citation
};

/// All materials, in groups from soft to stiff.
std::span<const NamedMaterial> named_materials();
/// All pairs of materials with known friction coefficients [1]. Each pair is listed once; the order of its two
/// materials has no meaning.
std::span<const KnownFriction> known_frictions();

/// Settings of the material called `name`. Throws SceneError if no material has this name.
///
/// - `friction` is the dynamic friction of two surfaces of this material if known_frictions() lists this pair, else the
///   default.
/// - Loss factors below 0.01 are left out. They belong to stiff materials, which suit implicit bodies, and implicit
///   bodies accept no loss factor.
MaterialSettings named_material(std::string_view name);

/// A term of the law of Ogden, with the constants that the literature uses; see ogden(). The modulus mu_p and the
/// exponent alpha_p must have the same sign.
struct OgdenTerm {
    Real modulus, exponent;  // mu_p [Pa] and alpha_p
};
/// Returns `base` with the law of Ogden (1972, eq. 18). Sets model, terms, young_modulus and poisson_ratio. Throws
/// SceneError unless there are one to three terms, mu_p alpha_p > 0 for each, and K > 0.
///
/// The energy per rest volume consists of a part for changes of shape and a part for changes of volume:
/// Psi = sum_p mu_p / alpha_p (s_1^alpha_p + s_2^alpha_p + s_3^alpha_p - 3) + K/2 (J - 1)^2
/// Here J = det F, s_i are the principal stretches divided by J^(1/3), and K is the bulk modulus [Pa].
MaterialSettings ogden(std::span<const OgdenTerm> terms, Real bulk_modulus, MaterialSettings base = {});

/// Returns `base` with the law of Mooney and Rivlin, which is the law of Ogden with the exponents 2 and -2.
///
/// With J = det F, let I_1 and I_2 be the first two invariants of the stretches divided by J^(1/3), and K the
/// `bulk_modulus`. The energy per rest volume is
/// Psi = c10 (I_1 - 3) + c01 (I_2 - 3) + K/2 (J - 1)^2
/// The constants c10, c01 and K are in [Pa].
MaterialSettings mooney_rivlin(Real c10, Real c01, Real bulk_modulus, MaterialSettings base = {});

/// Returns `base` with the law `orthotropic`, which is meant for strains of some per cent at any rotation. Sets model,
/// orthotropic, young_modulus and poisson_ratio. Throws SceneError if the stiffness is not positive definite; the
/// message states the violated condition.
MaterialSettings orthotropic(const OrthotropicModuli& moduli, MaterialSettings base = {});

}  // namespace skerry
#pragma GCC visibility pop
