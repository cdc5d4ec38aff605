#include "systems/dynamics/elements/element_energy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/geometry/symmetric_eigen.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

/// Calls visit(block, material, volume, F, frame) for every block for which is_requested(block) is true. Laws without a
/// corotational frame ignore the argument `frame`. The search for the frame of a lane starts from the lane's frame in
/// the previous block, because neighbours have similar rotations, so it also runs for skipped blocks.
template <class Ask, class Visit>
void for_each_block_of(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, Ask&& is_requested,
                       Visit&& visit) {
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const bool requested = is_requested(b);
        if (!requested && !has_frame(elements.constants[static_cast<std::size_t>(elements.material[b])].model))
            continue;
        const MaterialConstants material = elements.material_of(b);
        const Real8 volume = load(elements.volume[b]);
        const LaneMat3<Real8> F = deformation_gradient(elements.nodes_of(b), position);
        if (has_frame(material.model)) extract_rotation(F, volume, q);
        if (requested) visit(b, material, volume, F, rotation_of(q));
    }
}

template <class Visit>
void for_each_block(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, Visit&& visit) {
    for_each_block_of(
        elements, blocks, position, [](std::size_t) { return true; }, visit);
}

/// Cauchy stress of the elements of a block [Pa]; zero in lanes without volume.
LaneMat3<Real8> cauchy_stress_of(const Real8& volume, const LaneMat3<Real8>& F, const LaneMat3<Real8>& P) {
    // Lower limit of the divisor |J| in the Cauchy stress P F^T / |J|. It keeps the stress of flattened elements
    // finite.
    constexpr Real least_volume_ratio = 1e-6;
    const Real8 J = determinant(F), size = J < 0.0 ? -J : J, zero{};
    const Real8 ratio = size > least_volume_ratio ? size : zero + least_volume_ratio;
    // The stress in lanes without volume may not be finite, so it is replaced by zero.
    const auto column = [&](const Real8& x, const Real8& y, const Real8& z) -> LaneVec3<Real8> {
        const LaneVec3<Real8> sum = x * P.c0 + y * P.c1 + z * P.c2;
        return {volume > 0.0 ? sum.x / ratio : zero, volume > 0.0 ? sum.y / ratio : zero,
                volume > 0.0 ? sum.z / ratio : zero};
    };
    return {column(F.c0.x, F.c1.x, F.c2.x), column(F.c0.y, F.c1.y, F.c2.y), column(F.c0.z, F.c1.z, F.c2.z)};
}

/// Green strain (F^T F - I) / 2.
LaneMat3<Real8> green_strain_of(const LaneMat3<Real8>& F) {
    const Real8 xy = 0.5 * dot(F.c0, F.c1), yz = 0.5 * dot(F.c1, F.c2), zx = 0.5 * dot(F.c2, F.c0);
    return {{0.5 * (dot(F.c0, F.c0) - 1.0), xy, zx},
            {xy, 0.5 * (dot(F.c1, F.c1) - 1.0), yz},
            {zx, yz, 0.5 * (dot(F.c2, F.c2) - 1.0)}};
}

LaneMat3<Real8> stress_of(const MaterialConstants& material, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
    return with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame)
            return whole(law.stress(material, F, R), F);
        else
            return whole(law.stress(material, F), F);
    });
}

Real8 energy_of(const MaterialConstants& material, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
    return with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame)
            return law.energy_density(material, F, R);
        else
            return law.energy_density(material, F);
    });
}

}  // namespace

Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position) {
    Real energy = 0;
    for_each_block(elements, blocks, position,
                   [&](std::size_t b, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F,
                       const LaneMat3<Real8>& R) {
                       Real8 density = energy_of(material, F, R);
                       if (material.relaxes() && !elements.spring_strain.empty())
                           density += energy_density(viscous_moduli(material, elements.relaxing_share[b]),
                                                     springs_in(twice_green_strain(F), elements.spring_strain[b]));
                       const Real8 of_lanes = volume * density;
                       for (std::size_t l = 0; l < element_lanes; ++l) energy += of_lanes[l];
                   });
    return energy;
}

Real elastic_power(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Vec3> velocity) {
    Real power = 0;
    for_each_block(
        elements, blocks, position,
        [&](std::size_t b, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F,
            const LaneMat3<Real8>& R) {
            LaneMat3<Real8> P = stress_of(material, F, R);
            if (material.relaxes() && !elements.spring_strain.empty())
                P = P + multiply(F, stress(viscous_moduli(material, elements.relaxing_share[b]),
                                           springs_in(twice_green_strain(F), elements.spring_strain[b]).sum()));
            const Real8 of_lanes = volume * inner_product(P, deformation_gradient(elements.nodes_of(b), velocity));
            for (std::size_t l = 0; l < element_lanes; ++l) power += of_lanes[l];
        });
    return power;
}

void cauchy_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<Mat3> stress) {
    SKERRY_CHECK(stress.size() >= static_cast<std::size_t>(blocks.size()) * element_lanes);
    for_each_block(elements, blocks, position,
                   [&](std::size_t b, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F,
                       const LaneMat3<Real8>& R) {
                       const std::size_t first = (b - static_cast<std::size_t>(blocks.begin)) * element_lanes;
                       const LaneMat3<Real8> cauchy = cauchy_stress_of(volume, F, stress_of(material, F, R));
                       for (std::size_t l = 0; l < element_lanes; ++l)
                           stress[first + l] = lane_of(cauchy, static_cast<int>(l));
                   });
}

void element_fields(const ElementInputs& elements, Range blocks, std::span<const Index> requested,
                    std::span<const Vec3> position, std::span<ElementFields> fields) {
    SKERRY_CHECK(fields.size() >= requested.size() * element_lanes);
    if (requested.empty()) return;
    std::size_t next = 0;
    const auto is_requested = [&](std::size_t b) {
        return next < requested.size() && static_cast<std::size_t>(blocks.begin + requested[next]) == b;
    };
    const Range through_last{blocks.begin, blocks.begin + requested.back() + 1};
    for_each_block_of(elements, through_last, position, is_requested,
                      [&](std::size_t, const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F,
                          const LaneMat3<Real8>& R) {
                          const LaneMat3<Real8> P = stress_of(material, F, R), cauchy = cauchy_stress_of(volume, F, P),
                                                strain = green_strain_of(F);
                          for (int l = 0; l < static_cast<int>(element_lanes); ++l)
                              fields[next * element_lanes + static_cast<std::size_t>(l)] = {
                                  lane_of(F, l), lane_of(P, l), lane_of(cauchy, l), lane_of(strain, l)};
                          ++next;
                      });
}

void element_strains(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<Mat3> strain) {
    SKERRY_CHECK(strain.size() >= static_cast<std::size_t>(blocks.size()) * element_lanes);
    for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const LaneMat3<Real8> F = deformation_gradient(elements.nodes_of(b), position);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            Mat3& of_lane = strain[(b - static_cast<std::size_t>(blocks.begin)) * element_lanes + l];
            of_lane.setZero();
            if (!(elements.volume[b][l] > 0)) continue;
            const Mat3 f = lane_of(F, static_cast<int>(l));
            of_lane = (f.transpose() * f - Mat3::Identity()) / 2;
        }
    }
}

Real von_mises(const Mat3& cauchy) {
    const Mat3 deviator = cauchy - (cauchy.trace() / 3) * Mat3::Identity();
    return std::sqrt(1.5 * deviator.squaredNorm());
}

Vec3 principal_stresses(const Mat3& cauchy) {
    return symmetric_eigenvalues((cauchy + cauchy.transpose()) / 2).reverse();
}

}  // namespace skerry
