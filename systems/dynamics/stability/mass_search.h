// What the searches for the masses that elements take have in common (mass_forms.h, frame_masses.h).
#pragma once

#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Stiffness of explicit elements at rest, with what relaxes as it will count in steps of about the length that
/// elements bound one by one, times `longer`.
class RestModuli {
public:
    RestModuli(const ElementInputs& elements, Range blocks, Real longer);

    /// 1 of explicit elements, 0 of those that clusters carry, which take no mass.
    Real8 of_explicit(std::size_t block) const;

    struct Moduli {
        Real8 shear, volumetric;  // 2 mu and lambda, Pa
    };
    Moduli of(std::size_t block) const;

private:
    const ElementInputs& elements_;
    Real stiffest_ = 0;       // Pa
    Real relaxing_step_ = 0;  // s
};

/// Sorts nodes along the longest side of their bounding box.
void sort_along(std::span<const Vec3> position, std::span<Index> nodes);

/// Whether limit - matrix has a Cholesky decomposition, by more than rounding. `matrix`: of each row the band from the
/// diagonal on, `width` numbers. `rest`: scratch.
bool is_band_below(std::span<const Real> matrix, std::size_t width, Real limit, std::vector<Real>& rest);

}  // namespace skerry
