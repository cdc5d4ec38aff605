// Plastic flow of elements: radial return of the elastic strain to the yield surface (docs/methods/elasticity.md 8).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Plastic state of the elements. Plastic flow changes the rest shape of an element. With the inverse Fp^-1 of its
/// plastic deformation, the gradients g of its nodes become Fp^-T g, so that the deformation gradient computed from
/// them is its elastic part F Fp^-1. The mass forms change with the gradients, so that the element keeps its mass.
struct PlasticState {
    std::span<ElementGradient> gradient;    // ElementNodeTable
    std::span<ElementForm> mass_form;       // ElementBlockTable
    std::span<ElementLane> plastic_strain;  // ElementBlockTable

    static PlasticState of(ElementBlockTable& element, ElementNodeTable& nodes) {
        return {nodes.gradient, element.mass_form, element.plastic_strain};
    }
};

/// Number of blocks in a job of yield_elements().
inline constexpr std::size_t blocks_per_yield = 64;

/// Moves the elastic strain of all elements in a range of blocks back to the yield surface, at the given positions
/// (radial return, Simo 1992). Elements that do not yield, or are left out of the step, stay unchanged. An element with
/// a stretch or volume ratio below the limits of its law (Ogden::least_stretch, least_volume) does not flow. `parts`:
/// work memory, one entry per blocks_per_yield blocks. Parallel over blocks.
///
/// Returns the dissipated energy, the plastic work [J]. It contains only the work of the stress along the yield
/// surface. The excess of the elastic energy before the return is not included, because the stress before the return
/// never acted on the nodes.
Real yield_elements(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                    const PlasticState& state, std::span<Real> parts);

/// Undoes the plastic flow of all elements in a range of blocks. `rest_position`: positions of the mesh at rest.
/// `rotation`: rotation of the mesh when the elements were built. Sequential.
void forget_flow(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position, const Mat3& rotation,
                 const PlasticState& state);

}  // namespace skerry
