// Dense random contact problems: W = G G^T couples every contact with every other.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "systems/solver/operators/block_operator.h"

namespace skerry {

struct DenseProblem {
    std::vector<Index> row_offset, column, all;
    std::vector<Mat3> block;
    std::vector<Vec3> q;
    std::vector<Real> mu;

    DenseProblem(int contacts, int freedoms, Real friction, unsigned seed) {
        std::mt19937 random(seed);
        std::normal_distribution<Real> number;
        Eigen::MatrixXd g(3 * contacts, freedoms);
        for (Eigen::Index i = 0; i < g.size(); ++i) g.data()[i] = number(random);
        const Eigen::MatrixXd w = g * g.transpose();
        Eigen::VectorXd v(freedoms);
        for (Eigen::Index i = 0; i < freedoms; ++i) v[i] = number(random);
        const Eigen::VectorXd free = g * v;  // in the range of W, so that a solution exists
        row_offset.push_back(0);
        for (int i = 0; i < contacts; ++i) {
            for (int j = 0; j < contacts; ++j) {
                column.push_back(j);
                block.emplace_back(w.block<3, 3>(3 * i, 3 * j));
            }
            row_offset.push_back(static_cast<Index>(column.size()));
            q.emplace_back(free.segment<3>(3 * i));
            mu.push_back(friction);
            all.push_back(i);
        }
    }
    Index contacts() const { return static_cast<Index>(q.size()); }
    BlockSystem view() const { return {row_offset, column, block, q, mu}; }
    Vec3 velocity(std::size_t i, const std::vector<Vec4>& impulse) const {
        Vec3 u = q[i];
        for (std::size_t j = 0; j < q.size(); ++j) u += block[q.size() * i + j] * impulse[j].head<3>();
        return u;
    }
};

}  // namespace skerry
