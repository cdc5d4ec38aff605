// Least-squares fit of a polynomial of three variables to scattered samples.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "components/types.h"

namespace skerry {

/// Number of terms of a polynomial of three variables of degree 1 and 2.
inline constexpr int linear_terms = 4, quadratic_terms = 10;

/// Weighted least-squares fit of a linear or quadratic polynomial to samples with `values` components, evaluated at the
/// origin. Terms that the samples do not determine are dropped, from the highest to the lowest degree. So a linear
/// field is reproduced wherever the samples determine it.
template <int terms, int values>
class PolynomialFit {
public:
    using Sample = Eigen::Matrix<Real, 1, values>;

    /// Adds a sample at `offset` from the origin. Offsets should be of the order of 1.
    void add(Real weight, const Vec3& offset, const Sample& sample) {
        const Row row = row_at(offset);
        normal_.noalias() += weight * row.transpose() * row;
        right_.noalias() += weight * row.transpose() * sample;
    }

    /// Value of the polynomial at the origin; zero without samples. `rank`: number of terms that were not dropped.
    Sample at_origin(int& rank) const {
        // Cholesky decomposition, row by row. The diagonal after elimination of the earlier terms, over its first
        // value, is the squared sine of the angle between a term and the earlier terms, over all samples.
        constexpr Real dependent = 1e-3;
        Eigen::Matrix<Real, terms, terms> lower = Eigen::Matrix<Real, terms, terms>::Zero();
        Eigen::Matrix<Real, terms, values> value = right_;
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
            value.row(i) -= lower.row(i).head(i) * value.topRows(i);
            value.row(i) /= lower(i, i);
        }
        for (int i = terms - 1; i >= 0; --i) {
            if (!kept[static_cast<std::size_t>(i)]) {
                value.row(i).setZero();
                continue;
            }
            value.row(i) /= lower(i, i);
            value.topRows(i) -= lower.row(i).head(i).transpose() * value.row(i);
        }
        return value.row(0);
    }

private:
    using Row = Eigen::Matrix<Real, 1, terms>;

    static Row row_at(const Vec3& d) {
        Row row;
        row.template head<linear_terms>() << 1, d.x(), d.y(), d.z();
        if constexpr (terms == quadratic_terms)
            row.template tail<quadratic_terms - linear_terms>() << d.x() * d.x(), d.y() * d.y(), d.z() * d.z(),
                d.x() * d.y(), d.y() * d.z(), d.z() * d.x();
        return row;
    }

    Eigen::Matrix<Real, terms, terms> normal_ = Eigen::Matrix<Real, terms, terms>::Zero();
    Eigen::Matrix<Real, terms, values> right_ = Eigen::Matrix<Real, terms, values>::Zero();
};

}  // namespace skerry
