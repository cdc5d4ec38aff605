// Least-squares fit of a polynomial of three variables to scattered samples.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <span>

#include "components/types.h"

namespace skerry {

/// Numbers of terms of polynomials of degree 1 and 2 in three variables.
inline constexpr int linear_terms = 4, quadratic_terms = 10;

/// Weighted least-squares fit of a linear or quadratic polynomial to samples, evaluated at the origin. If the samples
/// do not determine all terms, terms of higher degree are dropped first. So a linear field is reproduced wherever the
/// samples determine it.
template <int terms>
class PolynomialFit {
public:
    /// Adds a sample at `offset` from the origin. Offsets should be of the order of 1.
    void add(Real weight, const Vec3& offset) {
        const Row row = row_at(offset);
        normal_.noalias() += weight * row.transpose() * row;
    }

    /// Returns the row r that gives the value of the fitted polynomial at the origin. This value is the sum over the
    /// samples i of weight_i (r . row_at(offset_i)) sample_i. The row is r = N^-1 (1, 0, 0, ...) with the normal matrix
    /// N of the fit, or zero without samples. `rank`: number of terms that were kept; a term that nearly depends on
    /// earlier ones is dropped.
    Eigen::Matrix<Real, 1, terms> row_of_origin(int& rank) const {
        // Cholesky decomposition of N, row by row. A term is dropped if elimination of the earlier terms reduces its
        // diagonal entry below the fraction `dependent`. The values of a term at all samples form a vector, and the
        // fraction is sin^2 of its angle to the span of the earlier terms.
        constexpr Real dependent = 1e-3;
        Eigen::Matrix<Real, terms, terms> lower = Eigen::Matrix<Real, terms, terms>::Zero();
        Eigen::Matrix<Real, terms, 1> value = Eigen::Matrix<Real, terms, 1>::Unit(0);
        std::array<bool, terms> kept{};
        rank = 0;
        for (int i = 0; i < terms; ++i) {
            for (int j = 0; j < i; ++j)
                if (kept[static_cast<std::size_t>(j)])
                    lower(i, j) = (normal_(i, j) - lower.row(i).head(j).dot(lower.row(j).head(j))) / lower(j, j);
            const Real left = normal_(i, i) - lower.row(i).head(i).squaredNorm();
            kept[static_cast<std::size_t>(i)] = left > dependent * normal_(i, i);
            if (!kept[static_cast<std::size_t>(i)]) {
                lower.row(i).setZero();
                continue;
            }
            ++rank;
            lower(i, i) = std::sqrt(left);
            value[i] = (value[i] - lower.row(i).head(i).dot(value.head(i))) / lower(i, i);
        }
        for (int i = terms - 1; i >= 0; --i) {
            if (!kept[static_cast<std::size_t>(i)]) {
                value[i] = 0;
                continue;
            }
            value[i] /= lower(i, i);
            value.head(i) -= lower.row(i).head(i).transpose() * value[i];
        }
        return value.transpose();
    }

    static Eigen::Matrix<Real, 1, terms> row_at(const Vec3& d) {
        Row row;
        row.template head<linear_terms>() << 1, d.x(), d.y(), d.z();
        if constexpr (terms == quadratic_terms)
            row.template tail<quadratic_terms - linear_terms>() << d.x() * d.x(), d.y() * d.y(), d.z() * d.z(),
                d.x() * d.y(), d.y() * d.z(), d.z() * d.x();
        return row;
    }

private:
    using Row = Eigen::Matrix<Real, 1, terms>;

    Eigen::Matrix<Real, terms, terms> normal_ = Eigen::Matrix<Real, terms, terms>::Zero();
};

/// Replaces the weights of samples by factors: the sum of factor * sample is the value of the fit at the origin.
/// Returns the number of terms that were not dropped. `offset`: positions of the samples relative to the origin.
template <int terms>
int find_fit_factors(std::span<const Vec3> offset, std::span<Real> weight) {
    PolynomialFit<terms> fit;
    for (std::size_t i = 0; i < offset.size(); ++i) fit.add(weight[i], offset[i]);
    int rank = 0;
    const auto row = fit.row_of_origin(rank);
    for (std::size_t i = 0; i < offset.size(); ++i) weight[i] *= row.dot(fit.row_at(offset[i]));
    return rank;
}

}  // namespace skerry
