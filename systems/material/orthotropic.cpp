#include "systems/material/orthotropic.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "systems/geometry/symmetric_eigen.h"
#include "systems/material/lane_power.h"
#include "systems/material/relaxation.h"

namespace skerry {

namespace {

constexpr std::size_t mode_count = 6;

LaneSymmetric<Real> mode_of(const MaterialConstants& material, std::size_t k) {
    const Real* const m = material.strain_modes.data() + 6 * k;
    return {m[0], m[1], m[2], m[3], m[4], m[5]};
}

/// Inner product m : a of a constant symmetric matrix with a symmetric matrix per lane.
template <class T>
T inner_with(const LaneSymmetric<Real>& m, const LaneSymmetric<T>& a) {
    return m.xx * a.xx + m.yy * a.yy + m.zz * a.zz + 2.0 * (m.xy * a.xy + m.yz * a.yz + m.zx * a.zx);
}

template <class T>
LaneSymmetric<T> in_lanes(const LaneSymmetric<Real>& m) {
    const T zero{};
    return {zero + m.xx, zero + m.yy, zero + m.zz, zero + m.xy, zero + m.yz, zero + m.zx};
}

/// Second Piola-Kirchhoff stress [Pa], from twice Green's strain.
template <class T>
LaneSymmetric<T> second_stress(const MaterialConstants& material, const LaneSymmetric<T>& strain) {
    const T pressure = (0.5 * material.lame_lambda) * strain.trace();
    LaneSymmetric<T> S{pressure, pressure, pressure, T{}, T{}, T{}};
    for (std::size_t k = 0; k < mode_count; ++k) {
        const LaneSymmetric<Real> mode = mode_of(material, k);
        S = S + T((0.5 * material.shear_modulus) * inner_with(mode, strain)) * in_lanes<T>(mode);
    }
    return S;
}

/// Energy density [J/m^3], from twice the strain.
template <class T>
T energy_of(const MaterialConstants& material, const LaneSymmetric<T>& strain) {
    T sum = material.lame_lambda * (strain.trace() * strain.trace());
    for (std::size_t k = 0; k < mode_count; ++k) {
        const T along = inner_with(mode_of(material, k), strain);
        sum = sum + material.shear_modulus * (along * along);
    }
    return 0.125 * sum;
}

/// Largest eigenvalue of sum_k M_k (x) M_k. It is the greatest |M_k|^2, because the matrices M_k are orthogonal to each
/// other.
Real largest_mode(const MaterialConstants& material) {
    Real largest = 0;
    for (std::size_t k = 0; k < mode_count; ++k) {
        const LaneSymmetric<Real> mode = mode_of(material, k);
        largest = std::max(largest, inner_product(mode, mode));
    }
    return largest;
}

template <class T>
T at_least(const T& a, Real least) {
    return a > least ? a : T{} + least;
}

Mat3 matrix_of(const LaneSymmetric<Real>& s) {
    Mat3 m;
    m << s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz;
    return m;
}

void set_mode(MaterialConstants& material, std::size_t k, const Mat3& m) {
    const std::array<Real, 6> entries{m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)};
    std::copy_n(entries.data(), entries.size(), material.strain_modes.data() + 6 * k);
}

}  // namespace

template <class T>
T Orthotropic::energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
    return energy_of(material, twice_green_strain(F));
}

template <class T>
LaneMat3<T> Orthotropic::stress(const MaterialConstants& material, const LaneMat3<T>& F) {
    return multiply(F, second_stress(material, twice_green_strain(F)));
}

template <class T>
T Orthotropic::rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J) {
    // With the stretches x of F / J^(1/3), (x - 1)^2 <= |F|^2 / J^(2/3) - 3, because the product of the stretches is 1.
    constexpr Real least_volume = 0.2;
    const auto regular = J > least_volume;
    const T cube_root = exp_of(log_of(regular ? J : T{} + 1.0) * (1.0 / 3)), area = cube_root * cube_root;
    const T most = 1.0 + square_root(at_least(square / area - 3.0, 0)), by_volume = area * (most * most);
    const T largest = regular & (by_volume < square) ? by_volume : square;  // upper bound of the squared stretches of F
    // |2 E|^2 is the sum of (s^2 - 1)^2 over the stretches s, with Green's strain E.
    const T strain = 0.5 * square_root(at_least(square * (largest - 2.0) + 3.0, 0));
    const Real stiffest = material.shear_modulus * largest_mode(material), lambda = std::max(material.lame_lambda, 0.0);
    return stiffest * (largest + strain) + lambda * (square + 0.5 * at_least(square - 3.0, 0)) +
           at_least(T{} - std::min(material.lame_lambda, 0.0) * 1.5, 0);
}

template <class T>
Orthotropic::Slope<T> Orthotropic::slope(const MaterialConstants& material, const LaneMat3<T>& F) {
    const LaneSymmetric<T> strain = twice_green_strain(F), S = second_stress(material, strain);
    const T mean = S.trace() * (1.0 / 3);
    const LaneSymmetric<T> deviator{S.xx - mean, S.yy - mean, S.zz - mean, S.xy, S.yz, S.zx};
    const T square = inner_product(F, F);
    Slope<T> slope;
    for (std::size_t k = 0; k < mode_count; ++k) slope.dyads[k] = multiply(F, in_lanes<T>(mode_of(material, k)));
    const Real at_rest = material.shear_modulus * largest_mode(material) + 3 * std::max(material.lame_lambda, 0.0);
    slope.rest = at_rest * at_least(1.0 - square * (1.0 / 3), 0) +
                 at_least(mean + 2.0 * square_root(inner_product(deviator, deviator) * (1.0 / 6)), 0);
    return slope;
}

template LaneMat3<Real> Orthotropic::stress(const MaterialConstants&, const LaneMat3<Real>&);
template LaneMat3<Real4> Orthotropic::stress(const MaterialConstants&, const LaneMat3<Real4>&);
template LaneMat3<Real8> Orthotropic::stress(const MaterialConstants&, const LaneMat3<Real8>&);
template Real Orthotropic::energy_density(const MaterialConstants&, const LaneMat3<Real>&);
template Real8 Orthotropic::energy_density(const MaterialConstants&, const LaneMat3<Real8>&);
template Orthotropic::Slope<Real4> Orthotropic::slope(const MaterialConstants&, const LaneMat3<Real4>&);
template Orthotropic::Slope<Real8> Orthotropic::slope(const MaterialConstants&, const LaneMat3<Real8>&);
template Real Orthotropic::rough_stiffness_bound(const MaterialConstants&, const Real&, const Real&);
template Real4 Orthotropic::rough_stiffness_bound(const MaterialConstants&, const Real4&, const Real4&);
template Real8 Orthotropic::rough_stiffness_bound(const MaterialConstants&, const Real8&, const Real8&);

Real Orthotropic::energy_density(const MaterialConstants& material, const Mat3& F) {
    return energy_density(material, from_matrix(F));
}

Real Orthotropic::energy_of_strain(const MaterialConstants& material, const Mat3& strain) {
    const Mat3 twice = 2 * strain;
    return energy_of(material,
                     LaneSymmetric<Real>{twice(0, 0), twice(1, 1), twice(2, 2), twice(0, 1), twice(1, 2), twice(2, 0)});
}

Mat3 Orthotropic::stress(const MaterialConstants& material, const Mat3& F) {
    return to_matrix(stress(material, from_matrix(F)));
}

Real Orthotropic::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    return stiffness_bound(material, from_matrix(F));
}

std::array<Mat3, 7> Orthotropic::dyads(const MaterialConstants& material, const Mat3& F) {
    std::array<Mat3, mode_count + 1> dyads;
    for (std::size_t k = 0; k < mode_count; ++k)
        dyads[k] = std::sqrt(material.shear_modulus) * F * matrix_of(mode_of(material, k));
    dyads[mode_count] = std::sqrt(std::max(material.lame_lambda, 0.0)) * F;
    return dyads;
}

Tangent Orthotropic::tangent(const MaterialConstants& material, const Mat3& F) {
    Tangent tangent{Mat3::Identity(), Mat3::Identity(), Mat3::Zero(), Vec3::Zero(), Vec3::Zero()};
    tangent.is_anisotropic = true;
    tangent.dyads = dyads(material, F);
    const SymmetricEigen axes = symmetric_eigen(matrix_of(second_stress(material, twice_green_strain(from_matrix(F)))));
    tangent.second_stress = axes.vectors * axes.values.cwiseMax(0).asDiagonal() * axes.vectors.transpose();
    return tangent;
}

Mat3 normal_stiffness(const OrthotropicModuli& moduli) {
    const Vec3 &E = moduli.young_modulus, &nu = moduli.poisson_ratio;
    Mat3 compliance = E.cwiseInverse().asDiagonal();
    compliance(0, 1) = compliance(1, 0) = -nu[0] / E[0];
    compliance(1, 2) = compliance(2, 1) = -nu[1] / E[1];
    compliance(0, 2) = compliance(2, 0) = -nu[2] / E[0];
    return compliance.inverse();
}

void set_orthotropic(const OrthotropicModuli& moduli, MaterialConstants& material) {
    // Isotropic material that is not stiffer than the orthotropic one for any strain. Its 2 mu is nine tenths of the
    // smallest eigenvalue of the orthotropic stiffness. Its lambda is the greatest for which the difference of both
    // stiffnesses has no negative eigenvalue.
    constexpr Real isotropic_share = 0.9;  // below 1, so that the stiffness minus 2 mu I stays positive definite
    const Mat3 normal = normal_stiffness(moduli);
    const Vec3& G = moduli.shear_modulus;
    const Real least = std::min(symmetric_eigenvalues(normal)[0], 2 * G.minCoeff());
    const Real twice_shear = isotropic_share * least;
    const Vec3 ones = Vec3::Ones();
    const Vec3 even = (normal - twice_shear * Mat3::Identity()).ldlt().solve(ones);
    material.shear_modulus = twice_shear / 2;
    material.lame_lambda = std::max(1 / even.sum(), 0.0);

    Mat3 axes;
    axes.col(0) = moduli.first_axis.normalized();
    axes.col(2) = axes.col(0).cross(moduli.second_axis).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    const SymmetricEigen modes = symmetric_eigen(normal - material.lame_lambda * Mat3::Ones());
    const auto set = [&](std::size_t k, Real modulus, const Mat3& unit) {
        set_mode(material, k, std::sqrt(modulus / material.shear_modulus) * axes * unit * axes.transpose());
    };
    for (Index k = 0; k < 3; ++k) {
        const auto number = static_cast<std::size_t>(k);
        set(number, modes.values[k], modes.vectors.col(k).asDiagonal());
        const Index i = k == 2 ? 0 : k, j = k == 0 ? 1 : 2;  // axes 12, 23, 13, as in shear_modulus
        Mat3 shear = Mat3::Zero();
        shear(i, j) = shear(j, i) = std::sqrt(0.5);
        set(3 + number, 2 * G[k], shear);
    }
}

void turn_axes(const Mat3& rotation, MaterialConstants& material) {
    for (std::size_t k = 0; k < mode_count; ++k)
        set_mode(material, k, rotation * matrix_of(mode_of(material, k)) * rotation.transpose());
}

}  // namespace skerry
