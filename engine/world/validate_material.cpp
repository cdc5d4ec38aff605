#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/world/validate.h"

namespace skerry {

namespace {

/// Checks the terms of Ogden's law: shares of the shear modulus must not be negative and must sum to 1, and exponents
/// must lie in a limited range. If no share is negative, each term is a convex function of the principal logarithmic
/// strains (Ogden 1972).
void require_terms(const MaterialSettings& material, const std::string& object) {
    constexpr Real least_exponent = 0.1, largest_exponent = 100, rounding = 1e-9;
    Real sum = 0;
    for (std::size_t p = 0; p < material.terms.size(); ++p) {
        const std::string field = "terms[" + std::to_string(p) + "]";
        const auto [share, exponent] = material.terms[p];
        require(share >= 0, object, field + ".share", share,
                "a share >= 0, because modulus and exponent have one sign");
        const Real size = std::abs(exponent);
        require(size >= least_exponent && size <= largest_exponent, object, field + ".exponent", exponent,
                "an exponent between 0.1 and 100 in size");
        sum += share;
    }
    require(std::abs(sum - 1) <= rounding, object, "terms", sum, "shares of the shear modulus that sum to 1");
}

/// Checks that the stiffness of an orthotropic material is positive definite, and that its two axes are not parallel.
void require_orthotropic(const OrthotropicModuli& moduli, const std::string& object) {
    const Vec3 &E = moduli.young_modulus, &nu = moduli.poisson_ratio, &G = moduli.shear_modulus;
    const std::array<const char*, 3> pair{"12", "23", "13"};
    for (Index i = 0; i < 3; ++i) {
        const std::string entry = "[" + std::to_string(i) + "]";
        require(E[i] > 0, object, "orthotropic.young_modulus" + entry, E[i], "a modulus > 0 (Pa)");
        require(G[i] > 0, object, "orthotropic.shear_modulus" + entry, G[i], "a modulus > 0 (Pa)");
    }
    for (Index k = 0; k < 3; ++k) {
        const Index first = k == 1 ? 1 : 0, second = k == 0 ? 1 : 2;
        const std::string name = pair[static_cast<std::size_t>(k)];
        const Real most = std::sqrt(E[first] / E[second]);
        require(std::abs(nu[k]) < most, object, "orthotropic.poisson_ratio[" + std::to_string(k) + "]", nu[k],
                ("a number between -" + shown(most) + " and " + shown(most) + ", the root of E" + name.substr(0, 1) +
                 "/E" + name.substr(1) + ", for a positive definite stiffness")
                    .c_str());
    }
    const Real rest = 1 - nu[0] * nu[0] * E[1] / E[0] - nu[1] * nu[1] * E[2] / E[1] - nu[2] * nu[2] * E[2] / E[0] -
                      2 * nu[0] * nu[1] * nu[2] * E[2] / E[0];
    constexpr Real least = 1e-6;
    require(rest >= least, object, "orthotropic.poisson_ratio", rest,
            "at least 1e-6 for 1 - nu12^2 E2/E1 - nu23^2 E3/E2 - nu13^2 E3/E1 - 2 nu12 nu23 nu13 E3/E1, for a positive "
            "definite stiffness");
    const Vec3 &first = moduli.first_axis, &second = moduli.second_axis;
    if (!first.allFinite() || !second.allFinite() ||
        !(first.cross(second).norm() > 1e-6 * first.norm() * second.norm()))
        refuse(object, "orthotropic.first_axis, second_axis", shown(first) + " and " + shown(second),
               "two directions that are not parallel; the default of second_axis is (0, 1, 0)");
}

void require_plasticity(const MaterialSettings& material, const Plasticity& plasticity, const std::string& object) {
    require(plasticity.yield_stress > 0, object, "plasticity.yield_stress", plasticity.yield_stress,
            "a stress > 0 (Pa)");
    require(plasticity.hardening >= 0, object, "plasticity.hardening", plasticity.hardening, "a modulus >= 0 (Pa)");
    if (material.model != MaterialModel::hencky)
        refuse(object, "model", std::string(name_of(material.model)), "hencky, the law of materials with plasticity");
}

}  // namespace

void validate(const MaterialSettings& material) {
    const std::string object = "material";
    if (material.model == MaterialModel::guard)
        refuse(object, "model", "guard", "another constitutive law (guard is for internal use)");
    require(material.young_modulus > 0, object, "young_modulus", material.young_modulus, "a modulus > 0 (Pa)");
    require(material.poisson_ratio > -1 && material.poisson_ratio < 0.5, object, "poisson_ratio",
            material.poisson_ratio, "a number > -1 and < 0.5");
    require(material.density > 0, object, "density", material.density, "a density > 0 (kg/m^3)");
    // Young's modulus and density may be any positive numbers that give a wave speed below the speed of light. Others
    // may give a stable step of 0, or one too short to advance the time. That error would otherwise appear only when a
    // body is added or in the first step.
    constexpr Real speed_of_light = 299792458;  // m/s
    const Real wave_speed = std::sqrt(material.young_modulus) / std::sqrt(material.density);
    if (!(wave_speed <= speed_of_light))
        refuse(object, "young_modulus, density",
               shown(material.young_modulus) + " Pa and " + shown(material.density) +
                   " kg/m^3, which give a wave speed of " + shown(wave_speed) + " m/s",
               "a wave speed below the speed of light (3e8 m/s)");
    require(material.friction >= 0, object, "friction", material.friction, "a number >= 0");
    const Real dynamic = material.dynamic_friction.value_or(material.friction);
    const Real still = material.static_friction.value_or(std::max(material.friction, dynamic));
    require(dynamic >= 0, object, "dynamic_friction", dynamic, "a number >= 0");
    require(still >= dynamic, object, "static_friction", still, "a number >= dynamic_friction");
    require(material.restitution >= 0 && material.restitution <= 1, object, "restitution", material.restitution,
            "a number from 0 to 1");
    require(material.damping >= 0, object, "damping", material.damping, "a rate >= 0 (1/s)");
    const Real loss_factor = material.loss_factor.value_or(default_loss_factor);
    require(loss_factor >= 0 && loss_factor <= largest_loss_factor, object, "loss_factor", loss_factor,
            "a number from 0 to 0.3");
    require_terms(material, object);
    if (material.model == MaterialModel::orthotropic) require_orthotropic(material.orthotropic, object);
    if (material.plasticity) require_plasticity(material, *material.plasticity, object);
    require(material.bulk_viscosity >= 0 && material.bulk_viscosity <= largest_bulk_viscosity, object, "bulk_viscosity",
            material.bulk_viscosity, "a number from 0 to 1");
}

}  // namespace skerry
