#include "systems/dynamics/implicit/block_cholesky.h"

#include <Eigen/Dense>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace skerry {

void BlockRows::multiply(std::span<const Vec3> x, std::span<Vec3> out) const {
    for (std::size_t k = 0; k < size(); ++k) {
        const auto first = static_cast<std::size_t>(offset[k]), last = static_cast<std::size_t>(offset[k + 1]) - 1;
        Vec3 sum = block[last] * x[k];
        for (std::size_t i = first; i < last; ++i) {
            const auto j = static_cast<std::size_t>(column[i]);
            sum += block[i] * x[j];
            out[j] += block[i].transpose() * x[k];  // row j < k is already initialised
        }
        out[k] = sum;
    }
}

std::vector<Index> elimination_order(const std::vector<std::vector<Index>>& neighbours) {
    const auto count = static_cast<int>(neighbours.size());
    std::vector<Eigen::Triplet<double, int>> entry;
    for (int n = 0; n < count; ++n) {
        entry.emplace_back(n, n, 1.0);
        for (const Index other : neighbours[static_cast<std::size_t>(n)]) entry.emplace_back(n, other, 1.0);
    }
    Eigen::SparseMatrix<double, Eigen::ColMajor, int> pattern(count, count);
    pattern.setFromTriplets(entry.begin(), entry.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> node_at;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), node_at);
    std::vector<Index> order_index(neighbours.size());
    for (int k = 0; k < count; ++k) order_index[static_cast<std::size_t>(node_at.indices()[k])] = k;
    return order_index;
}

BlockCholesky::BlockCholesky(const BlockRows& pattern)
    : parent_(pattern.size(), no_index),
      inverse_diagonal_(pattern.size()),
      mark_(pattern.size()),
      path_(pattern.size()),
      stack_(pattern.size()),
      end_(pattern.size()),
      sum_(pattern.size(), Mat3::Zero()) {
    std::vector<std::size_t> count(pattern.size(), 0);
    for (std::size_t k = 0; k < pattern.size(); ++k) {
        const auto row = static_cast<Index>(k);
        mark_[k] = row;
        for (Index i = pattern.offset[k]; i < pattern.offset[k + 1]; ++i)
            for (Index j = pattern.column[static_cast<std::size_t>(i)]; mark_[static_cast<std::size_t>(j)] != row;
                 j = parent_[static_cast<std::size_t>(j)]) {
                Index& parent = parent_[static_cast<std::size_t>(j)];
                if (parent == no_index) parent = row;
                ++count[static_cast<std::size_t>(j)];
                mark_[static_cast<std::size_t>(j)] = row;
            }
    }
    first_.push_back(0);
    for (const std::size_t of_column : count) first_.push_back(first_.back() + of_column);
    row_.resize(first_.back());
    block_.resize(first_.back());
}

std::span<const Index> BlockCholesky::columns_of(const BlockRows& pattern, Index k) {
    const auto row = static_cast<std::size_t>(k);
    std::size_t top = stack_.size();
    mark_[row] = k;
    for (Index i = pattern.offset[row]; i < pattern.offset[row + 1]; ++i) {
        std::size_t length = 0;
        for (Index j = pattern.column[static_cast<std::size_t>(i)]; mark_[static_cast<std::size_t>(j)] != k;
             j = parent_[static_cast<std::size_t>(j)]) {
            path_[length++] = j;
            mark_[static_cast<std::size_t>(j)] = k;
        }
        while (length > 0) stack_[--top] = path_[--length];
    }
    return std::span<const Index>(stack_).subspan(top);
}

bool BlockCholesky::factor(const BlockRows& matrix) {
    for (std::size_t k = 0; k < end_.size(); ++k) end_[k] = first_[k];
    std::ranges::fill(mark_, no_index);
    for (std::size_t k = 0; k < matrix.size(); ++k) {
        const auto row = static_cast<Index>(k);
        const auto last = static_cast<std::size_t>(matrix.offset[k + 1]) - 1;
        for (auto i = static_cast<std::size_t>(matrix.offset[k]); i < last; ++i)
            sum_[static_cast<std::size_t>(matrix.column[i])] = matrix.block[i].transpose();
        Mat3 diagonal = matrix.block[last];
        for (const Index column : columns_of(matrix, row)) {
            const auto j = static_cast<std::size_t>(column);
            const Mat3 of_row = inverse_diagonal_[j] * sum_[j];  // L_kj^T
            sum_[j].setZero();
            for (std::size_t p = first_[j]; p < end_[j]; ++p)
                sum_[static_cast<std::size_t>(row_[p])].noalias() -= block_[p] * of_row;
            diagonal.noalias() -= of_row.transpose() * of_row;
            row_[end_[j]] = row;
            block_[end_[j]++] = of_row.transpose();
        }
        const Eigen::LLT<Mat3> root(diagonal);
        if (root.info() != Eigen::Success) {
            std::ranges::fill(sum_, Mat3::Zero());
            return false;
        }
        inverse_diagonal_[k] = root.matrixL().solve(Mat3::Identity());
    }
    return true;
}

template <class X>
void BlockCholesky::solve_in_place(X* x) const {
    const std::size_t count = inverse_diagonal_.size();
    for (std::size_t j = 0; j < count; ++j) {
        const X of_column = inverse_diagonal_[j] * x[j];
        x[j] = of_column;
        for (std::size_t p = first_[j]; p < first_[j + 1]; ++p)
            x[static_cast<std::size_t>(row_[p])].noalias() -= block_[p] * of_column;
    }
    for (std::size_t j = count; j-- > 0;) {
        X sum = x[j];
        for (std::size_t p = first_[j]; p < first_[j + 1]; ++p)
            sum.noalias() -= block_[p].transpose() * x[static_cast<std::size_t>(row_[p])];
        x[j] = inverse_diagonal_[j].transpose() * sum;
    }
}

template void BlockCholesky::solve_in_place(Vec3* x) const;
template void BlockCholesky::solve_in_place(Mat3* x) const;

}  // namespace skerry
