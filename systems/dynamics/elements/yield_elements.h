// Plastic flow of elements: radial return of the elastic strain to the yield surface (docs/methods/elasticity.md 8).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Plastic state of the elements. Plastic flow changes the rest shape of an element: with its plastic deformation Fp,
/// the gradients g of its nodes become Fp^-T g. The deformation gradient computed from them is then the elastic part F
/// Fp^-1 (docs/methods/elasticity.md 8). The mass forms change with the gradients, so that the element keeps its mass.
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
/// (radial return, Simo 1992). `parts`: work memory, one entry per blocks_per_yield blocks. Parallel over blocks. These
/// elements stay unchanged:
/// - elements that do not yield, or are left out of the step;
/// - elements with a stretch or volume ratio below the limits of their law (Ogden::least_stretch, least_volume).
///
/// Returns the dissipated energy, the plastic work [J]: the work of the stress along the yield surface. The excess of
/// the elastic energy before the return is not included, because the stress before the return never acted on the nodes.
Real yield_elements(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                    const PlasticState& state, std::span<Real> parts);

/// Undoes the plastic flow of all elements in a range of blocks. `rest_position`: positions of the mesh at rest.
/// `rotation`: rotation of the mesh when the elements were built. Sequential.
void forget_flow(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position, const Mat3& rotation,
                 const PlasticState& state);

}  // namespace skerry
