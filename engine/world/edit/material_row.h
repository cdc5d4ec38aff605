// The values of one row of MaterialTable, read from the table or computed from settings.
#pragma once

#include "components/material_table.h"
#include "engine/world/edit/edit_model.h"
#include "systems/material/material_law.h"
#include "systems/material/orthotropic.h"

namespace skerry {

struct MaterialRow {
    MaterialConstants constants;
    SurfaceProperties surface;
    Real young_modulus, poisson_ratio, damping;
    OrthotropicModuli orthotropic;
    bool sets_losses;  // true if the user has set a loss factor above 0

    static MaterialRow of(const MaterialTable& table, std::size_t row) {
        return {table.constants[row], table.surface[row],     table.young_modulus[row],   table.poisson_ratio[row],
                table.damping[row],   table.orthotropic[row], table.sets_losses[row] != 0};
    }
    static MaterialRow of(const MaterialSettings& material) {
        MaterialRow row{
            material_constants(material.model, material.young_modulus, material.poisson_ratio, material.density),
            surface_properties(
                {material.friction, material.static_friction, material.dynamic_friction, material.restitution}),
            material.young_modulus,
            material.poisson_ratio,
            material.damping,
            material.orthotropic,
            material.loss_factor.value_or(0) > 0};
        row.constants.loss_factor = material.loss_factor.value_or(default_loss_factor);
        row.constants.bulk_viscosity = material.bulk_viscosity;
        for (std::size_t p = 0; p < material.terms.size(); ++p) {
            row.constants.share[p] = material.terms[p].share;
            row.constants.exponent[p] = material.terms[p].exponent;
        }
        if (material.model == MaterialModel::orthotropic) {
            set_orthotropic(material.orthotropic, row.constants);
            const IsotropicModuli softer = isotropic_moduli(row.constants);
            row.young_modulus = softer.young_modulus;
            row.poisson_ratio = softer.poisson_ratio;
        }
        if (material.plasticity) {
            row.constants.yield_stress = material.plasticity->yield_stress;
            row.constants.hardening = material.plasticity->hardening;
        }
        return row;
    }
    void write(MaterialTable& table, std::size_t row) const {
        table.constants[row] = constants;
        table.surface[row] = surface;
        table.young_modulus[row] = young_modulus;
        table.poisson_ratio[row] = poisson_ratio;
        table.damping[row] = damping;
        table.orthotropic[row] = orthotropic;
        table.sets_losses[row] = sets_losses;
    }
    /// True if elements of both materials have the same elastic forces, masses and losses. Plastic flow may differ.
    bool same_elements(const MaterialRow& other) const {
        const MaterialConstants &a = constants, &b = other.constants;
        return young_modulus == other.young_modulus && poisson_ratio == other.poisson_ratio && a.density == b.density &&
               a.loss_factor == b.loss_factor && a.bulk_viscosity == b.bulk_viscosity && a.share == b.share &&
               a.exponent == b.exponent && orthotropic == other.orthotropic;
    }
    bool same_rest(const MaterialRow& other) const {
        return surface == other.surface && damping == other.damping && sets_losses == other.sets_losses &&
               constants.yield_stress == other.constants.yield_stress &&
               constants.hardening == other.constants.hardening;
    }
};

}  // namespace skerry
