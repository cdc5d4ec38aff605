#include "systems/solver/operators/block_operator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace skerry {

static_assert(ContactOperator<BlockOperator>);

namespace {

/// Returns `start` plus the sum over the off-diagonal blocks of a row of W, each times the vector of its contact. Three
/// partial sums hide the latency of additions.
inline Vec4 add_row(const BlockMemory& memory, Index index, const Vec4& start, const Vec4* vector) {
    Vec4 first = start, second = Vec4::Zero(), third = Vec4::Zero();
    const BlockMemory::Columns* block = memory.block.data();
    const Index* neighbor = memory.neighbor.data();
    for (Index k = memory.offset[index], end = memory.offset[index + 1]; k < end; ++k) {
        const Vec4& other = vector[neighbor[k]];
        first += block[k][0] * other[0];
        second += block[k][1] * other[1];
        third += block[k][2] * other[2];
    }
    return first + (second + third);
}

/// Returns max(normal, 0). NaN stays NaN.
inline Real positive_part(Real normal) {
    return std::max(normal, Real(0));
}

/// Solves the scalar rows of Lazarevych et al. (2010) one after the other: first the normal, then each tangent with the
/// bound from the new normal impulse (eq. 6, 15).
Vec4 step_pyramid(const BlockMemory::Columns& block, const Vec4& impulse, Vec4 u, Real mu, Real relaxation) {
    Vec4 next = impulse;
    for (int k = 0; k < 3; ++k) {
        if (!(block[k][k] > 0)) continue;
        const Real unclamped = impulse[k] - relaxation * u[k] / block[k][k];
        next[k] = k == 0 ? positive_part(unclamped) : std::clamp(unclamped, -mu * next[0], mu * next[0]);
        u += (next[k] - impulse[k]) * block[k];
    }
    return next;
}

/// Projects an impulse onto the friction pyramid in the contact frame: clamps each tangential component separately.
Vec4 clamp_to_pyramid(const Vec4& impulse, Real mu) {
    const Real normal = positive_part(impulse[0]);
    return {normal, std::clamp(impulse[1], -mu * normal, mu * normal),
            std::clamp(impulse[2], -mu * normal, mu * normal), 0};
}

}  // namespace

void BlockMemory::prepare(const BlockSystem& system, std::span<const Index> order) {
    const std::size_t count = order.size();
    std::vector<Index> index(count);
    for (std::size_t i = 0; i < count; ++i) index[order[i]] = static_cast<Index>(i);
    contact.resize(count);
    offset.assign(count + 1, 0);
    neighbor.clear();
    block.clear();
    neighbor.reserve(system.column.size());
    block.reserve(system.column.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Index row = order[i];
        Mat3 diagonal = Mat3::Zero();
        for (Index k = system.row_offset[row]; k < system.row_offset[row + 1]; ++k) {
            if (system.column[k] == row) {
                diagonal = system.block[k];
            } else {
                neighbor.push_back(index[system.column[k]]);
                block.push_back(columns_of(system.block[k]));
            }
        }
        offset[i + 1] = static_cast<Index>(neighbor.size());
        contact[i] = {padded(system.q[row]), columns_of(diagonal), columns_of(0.5 * (diagonal - diagonal.transpose())),
                      prepare_block(diagonal), system.mu[row]};
    }
    impulse.assign(count, Vec4::Zero());
    for (std::vector<Vec4>& slot : workspace) slot.resize(count);
}

Vec3 natural_map(const Vec3& impulse, const Vec3& u, Real mu, Friction friction) {
    if (friction == Friction::pyramid) {
        // The tangential limit uses the present normal impulse, not the projected one.
        const Real limit = mu * positive_part(impulse[0]);
        return {impulse[0] - positive_part(impulse[0] - u[0]),
                impulse[1] - std::clamp(impulse[1] - u[1], -limit, limit),
                impulse[2] - std::clamp(impulse[2] - u[2], -limit, limit)};
    }
    // Returns r minus the projection of r - u - mu |u_t| n onto the cone.
    const Real shift = mu * std::sqrt(u[1] * u[1] + u[2] * u[2]);
    const Real along = impulse[0] - u[0] - shift;
    const Real t1 = impulse[1] - u[1], t2 = impulse[2] - u[2];
    const Real length = std::sqrt(t1 * t1 + t2 * t2);
    if (mu * length <= -along) return impulse;
    if (length <= mu * along) return {impulse[0] - along, impulse[1] - t1, impulse[2] - t2};
    const Real nearest = (along + mu * length) / (1 + mu * mu);
    const Real shrink = length > 0 ? mu * nearest / length : 0;
    return {impulse[0] - nearest, impulse[1] - shrink * t1, impulse[2] - shrink * t2};
}

BlockOperator::BlockOperator(BlockMemory& memory, Index begin, Index end, Friction friction, Real smallest_size)
    : memory_(memory),
      begin_(begin),
      end_(end),
      friction_(friction),
      smallest_size_(smallest_size),
      size_(smallest_size) {}

Vec4 BlockOperator::velocity(Index index) const {
    const BlockMemory::Contact& contact = memory_.contact[index];
    return add_row(memory_, index, contact.q + times(contact.diagonal, memory_.impulse[index]), memory_.impulse.data());
}

inline Real BlockOperator::step(Index i, Real relaxation) {
    const Index index = begin_ + i;
    BlockMemory::Contact& contact = memory_.contact[index];
    const Vec4 before = memory_.impulse[index];
    const Vec4 b = add_row(memory_, index, contact.q, memory_.impulse.data());
    Vec4 next;
    if (friction_ == Friction::pyramid) {
        next = step_pyramid(contact.diagonal, before, b + times(contact.diagonal, before), contact.mu, relaxation);
    } else {
        // Rounding in files makes W slightly asymmetric. solve_block uses only the symmetric part of the diagonal
        // block. So the skew part is multiplied by the last impulse and added to the constant part of the velocity.
        const Vec4 fixed = b + times(contact.skew, before);
        next = padded(solve_block(contact.local, fixed.head<3>(), contact.mu));
        if (relaxation != 1) next = project(i, before + relaxation * (next - before));
    }
    const Vec4 change = next - before;
    if (change.isZero(0)) return 0;
    memory_.impulse[index] = next;
    const Real size = change.dot(times(contact.diagonal, change));
    // Adds an estimate of |F_i|^2, where F_i is the natural map with the factor 1 instead of 1/D_i
    // (docs/methods/errors.md 3). For an impulse change d, |F_i| is estimated as the smaller of |d| and the velocity
    // change that d causes.
    swept_ += std::min(change.squaredNorm(), mobility(i) * size);
    return size;
}

Real BlockOperator::sweep(Real relaxation) {
    Real change = 0;
    for (Index i = 0; i < size(); ++i) change += step(i, relaxation);
    return change;
}

SweepChange BlockOperator::accelerated_sweep(Real relaxation) {
    const std::span<const Vec4> present = impulse(), previous = workspace(1);
    SweepChange sum;
    for (Index i = 0; i < size(); ++i) {
        const Vec4 before = present[i];
        const Real size = step(i, relaxation);
        if (size == 0) continue;
        sum.squared_change += size;
        sum.reversal -= inner(i, present[i] - before, present[i] - previous[i]);
    }
    return sum;
}

bool BlockOperator::suggests_check(Real, Real tolerance) {
    last_swept_ = std::exchange(swept_, 0);
    return calibration_ * last_swept_ <= tolerance * tolerance * size_ * size_;
}

Real BlockOperator::error() {
    Real squared_residual = 0, q = 0, r = 0, u = 0;
    for (Index index = begin_; index < end_; ++index) {
        const BlockMemory::Contact& contact = memory_.contact[index];
        const Vec4 velocity_now = velocity(index);
        const Vec4& impulse_now = memory_.impulse[index];
        squared_residual +=
            natural_map(impulse_now.head<3>(), velocity_now.head<3>(), contact.mu, friction_).squaredNorm();
        q += contact.q.squaredNorm();
        r += impulse_now.squaredNorm();
        u += velocity_now.squaredNorm();
    }
    size_ = std::sqrt(std::max({q, r, u, smallest_size_ * smallest_size_}));
    if (last_swept_ > 0) calibration_ = squared_residual / last_swept_;
    return squared_residual == 0 ? 0 : std::sqrt(squared_residual) / size_;
}

void BlockOperator::remember() {
    std::ranges::copy(impulse(), workspace(1).begin());
}

void BlockOperator::extrapolate(Real factor) {
    extrapolate_range(0, impulse().size(), factor, impulse(), workspace(1));
}

void BlockOperator::residual(std::span<Vec4> out) const {
    for (Index i = 0; i < size(); ++i) out[i] = -velocity(begin_ + i);
}

void BlockOperator::multiply(std::span<const Vec4> in, std::span<Vec4> out) const {
    for (Index i = 0; i < size(); ++i)
        out[i] = add_row(memory_, begin_ + i, times(memory_.contact[begin_ + i].diagonal, in[i]), in.data() - begin_);
}

Vec4 BlockOperator::project(Index i, const Vec4& impulse) const {
    const Real mu = memory_.contact[begin_ + i].mu;
    if (friction_ == Friction::pyramid) return clamp_to_pyramid(impulse, mu);
    return project_friction(impulse, normal(i), {mu, mu}, friction_);
}

Vec4 BlockOperator::feasible(Index i, const Vec4& residual) const {
    return feasible_direction(residual, memory_.impulse[begin_ + i], normal(i), limits(i), friction_);
}

void BlockOperator::assemble(Eigen::MatrixXd& matrix) const {
    matrix.setZero(3 * size(), 3 * size());
    const auto put = [&](Index i, Index j, const BlockMemory::Columns& block) {
        for (int c = 0; c < 3; ++c) matrix.block<3, 1>(3 * i, 3 * j + c) = block[c].head<3>();
    };
    for (Index i = 0; i < size(); ++i) {
        put(i, i, memory_.contact[begin_ + i].diagonal);
        for (Index k = memory_.offset[begin_ + i]; k < memory_.offset[begin_ + i + 1]; ++k)
            put(i, memory_.neighbor[k] - begin_, memory_.block[k]);
    }
}

}  // namespace skerry
