#include "systems/dynamics/element_energy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "systems/dynamics/element_block.h"
#include "systems/material/corotational.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/linear.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

namespace {

/// Calls visit(block, material, volume, F, frame) for every block. The frame of a corotational element starts from the same lane of the
/// block before it: neighbours turn together. Other models have none.
template <class Visit>
void for_each_block(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, Visit&& visit) {
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
        const Real8 volume = load(elements.volume[b]);
        const LaneMat3<Real8> F = deformation_gradient(edges(elements.node[b], position), elements.inverse_rest[b]);
        if (material.model == MaterialModel::corotational) extract_rotation(F, volume, q);
        visit(b, material, volume, F, rotation_of(q));
    }
}

LaneMat3<Real8> stress_of(const MaterialConstants& material, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
    switch (material.model) {
        case MaterialModel::linear:
            return linear::stress(material, F);
        case MaterialModel::corotational:
            return corotational::stress(material, F, R);
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return stable_neo_hookean::stress(material, F);
}

Real8 energy_of(const MaterialConstants& material, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
    switch (material.model) {
        case MaterialModel::linear:
            return linear::energy_density(material, F);
        case MaterialModel::corotational:
            return corotational::energy_density(material, F, R);
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return stable_neo_hookean::energy_density(material, F);
}

}  // namespace

Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position) {
    Real energy = 0;
    for_each_block(
        elements, blocks, position,
        [&](std::size_t, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
            const Real8 of_lanes = volume * energy_of(material, F, R);
            for (std::size_t l = 0; l < element_lanes; ++l) energy += of_lanes[l];
        });
    return energy;
}

void von_mises_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Real> von_mises) {
    SKERRY_CHECK(von_mises.size() >= static_cast<std::size_t>(blocks.size()) * element_lanes);
    constexpr Real least_volume_ratio = 1e-6;  // below it the Cauchy stress has no meaning; the cap keeps it finite
    for_each_block(
        elements, blocks, position,
        [&](std::size_t b, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
            const LaneMat3<Real8> P = stress_of(material, F, R);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Mat3 f = lane_of(F, static_cast<int>(l));
                const Real ratio = std::max(std::abs(f.col(0).dot(f.col(1).cross(f.col(2)))), least_volume_ratio);
                const Mat3 cauchy = lane_of(P, static_cast<int>(l)) * f.transpose() / ratio;
                const Mat3 deviator = cauchy - (cauchy.trace() / 3) * Mat3::Identity();
                von_mises[(b - static_cast<std::size_t>(blocks.begin)) * element_lanes + l] =
                    volume[l] > 0 ? std::sqrt(1.5 * deviator.squaredNorm()) : 0;
            }
        });
}

VolumeRatios measure_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position) {
    VolumeRatios worst{std::numeric_limits<Real>::infinity(), no_index};
    for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const LaneMat3<Real8> F = deformation_gradient(edges(elements.node[b], position), elements.inverse_rest[b]);
        const Real8 ratio = dot(F.c0, cross(F.c1, F.c2));
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(elements.volume[b][l] > 0)) continue;
            const Index here = static_cast<Index>(b * element_lanes + l);
            worst.near_inversion += ratio[l] < near_inversion;
            worst.inverted += ratio[l] < 0;
            if (std::isnan(worst.smallest) || ratio[l] >= worst.smallest) continue;  // not passed by a number that is none
            worst.smallest = ratio[l];
            worst.element = here;
        }
    }
    return worst;
}

}  // namespace skerry
