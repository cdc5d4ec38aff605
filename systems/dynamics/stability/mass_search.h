// What the searches for the masses that elements take have in common (mass_forms.h, frame_masses.h).
#pragma once

#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/material/relaxation.h"

namespace skerry {

inline LaneSymmetric<Real8> load_form(const ElementForm& form) {
    return {load(form[0]), load(form[1]), load(form[2]), load(form[3]), load(form[4]), load(form[5])};
}

inline LaneSymmetric<Real8> inverse_of(const LaneSymmetric<Real8>& s) {
    const Real8 xx = s.yy * s.zz - s.yz * s.yz, xy = s.zx * s.yz - s.xy * s.zz, zx = s.xy * s.yz - s.zx * s.yy;
    const Real8 scale = 1.0 / (s.xx * xx + s.xy * xy + s.zx * zx);
    return {scale * xx, scale * (s.xx * s.zz - s.zx * s.zx), scale * (s.xx * s.yy - s.xy * s.xy),
            scale * xy, scale * (s.xy * s.zx - s.xx * s.yz), scale * zx};
}

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
