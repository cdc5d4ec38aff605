#include "engine/estimate/energy_norm.h"

#include <cmath>
#include <numbers>

namespace skerry {

namespace {

using Vec6 = Eigen::Matrix<Real, 6, 1>;

/// Entries of a symmetric matrix in Mandel notation: off-diagonal entries are multiplied by the root of two, so that
/// the scalar product of two vectors equals the double contraction of the matrices.
Vec6 entries_of(const Mat3& symmetric) {
    constexpr Real root = std::numbers::sqrt2;
    return {symmetric(0, 0),        symmetric(1, 1),        symmetric(2, 2),
            root * symmetric(0, 1), root * symmetric(1, 2), root * symmetric(2, 0)};
}

}  // namespace

EnergyNorm::EnergyNorm(const MaterialConstants& material, bool splits)
    : is_anisotropic_(material.model == MaterialModel::orthotropic) {
    const Real mu = material.shear_modulus, lambda = material.lame_lambda;
    // If some elements carry only one of the parts of ElementPart, every stress is divided into these parts. Otherwise
    // it is divided into deviator and mean stress, whose stiffnesses, 2 mu and the bulk modulus, are positive for all
    // Poisson ratios.
    const MaterialConstants volumetric = part_of(material, ElementPart::volume);
    const Real bulk = lambda + 2 * mu / 3, modulus = splits ? volumetric.lame_lambda : bulk;
    of_shear_ = 1 / std::sqrt(2 * mu);
    of_volume_ = modulus > 0 ? 1 / std::sqrt(modulus) : 0;  // without stiffness there is no volumetric stress
    pressure_ = modulus / (3 * bulk);
    if (!is_anisotropic_) return;
    Eigen::Matrix<Real, 6, 6> stiffness = Eigen::Matrix<Real, 6, 6>::Zero();
    for (std::size_t k = 0; k < 6; ++k) {
        const Vec6 mode =
            Eigen::Map<const Vec6>(material.strain_modes.data() + 6 * k).cwiseProduct(entries_of(Mat3::Ones()));
        stiffness += mu * mode * mode.transpose();
    }
    stiffness.topLeftCorner<3, 3>().array() += lambda;
    of_all_ = stiffness.llt().matrixL().solve(Eigen::Matrix<Real, 6, 6>::Identity());
}

StressCoordinates EnergyNorm::of(const Mat3& stress, ElementPart part, const Mat3& turn) const {
    StressCoordinates coordinates = StressCoordinates::Zero();
    if (is_anisotropic_) {
        coordinates.head<6>() = of_all_ * entries_of(turn.transpose() * stress * turn);
        return coordinates;
    }
    const Real pressure = part == ElementPart::whole    ? pressure_ * stress.trace()
                          : part == ElementPart::volume ? stress.trace() / 3
                                                        : 0;
    coordinates[6] = of_volume_ * pressure;
    if (part != ElementPart::volume)
        coordinates.head<6>() = of_shear_ * entries_of(stress - pressure * Mat3::Identity());
    return coordinates;
}

}  // namespace skerry
