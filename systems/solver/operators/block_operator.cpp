#include "systems/solver/operators/block_operator.h"

#include <algorithm>
#include <cmath>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

static_assert(ContactOperator<BlockOperator>);

namespace {

/// The paper's scalar rows in turn: normal, then each tangent with the new bound (eq. 6, 15).
Vec3 step_pyramid(const Mat3& block, const Vec3& impulse, Vec3 u, Real mu, Real relaxation) {
    Vec3 next = impulse;
    for (int k = 0; k < 3; ++k) {
        if (!(block(k, k) > 0)) continue;
        const Real wanted = impulse[k] - relaxation * u[k] / block(k, k);
        next[k] = k == 0 ? std::max(Real(0), wanted) : std::clamp(wanted, -mu * next[0], mu * next[0]);
        u += (next[k] - impulse[k]) * block.col(k);
    }
    return next;
}

/// Box of the pyramid in the frame of the contact.
Vec3 clamp_to_pyramid(const Vec3& impulse, Real mu) {
    const Real normal = std::max(Real(0), impulse[0]);
    return {normal, std::clamp(impulse[1], -mu * normal, mu * normal), std::clamp(impulse[2], -mu * normal, mu * normal)};
}

}  // namespace

void BlockMemory::prepare(const BlockSystem& system) {
    const std::size_t count = system.q.size();
    local.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        Mat3 diagonal = Mat3::Zero();
        for (Index k = system.row_offset[i]; k < system.row_offset[i + 1]; ++k)
            if (system.column[k] == static_cast<Index>(i)) diagonal = system.block[k];
        local[i] = prepare_block(diagonal);
    }
    impulse.assign(count, Vec3::Zero());
    gathered.resize(count);
    for (std::vector<Vec3>& slot : workspace) slot.resize(count);
}

Vec3 natural_map(const Vec3& impulse, const Vec3& u, Real mu, Friction friction) {
    if (friction == Friction::pyramid) {
        // each tangent is limited by the normal impulse there is, not by the one the map asks for
        const Real limit = mu * std::max(Real(0), impulse[0]);
        return {impulse[0] - std::max(Real(0), impulse[0] - u[0]), impulse[1] - std::clamp(impulse[1] - u[1], -limit, limit),
                impulse[2] - std::clamp(impulse[2] - u[2], -limit, limit)};
    }
    const Vec3 shifted(u[0] + mu * std::hypot(u[1], u[2]), u[1], u[2]);
    return impulse - project_onto_cone(Vec3(impulse - shifted), Vec3(Vec3::UnitX()), mu);
}

BlockOperator::BlockOperator(const BlockSystem& system, std::span<const Index> row, Friction friction, Real smallest_size,
                             BlockMemory& memory)
    : system_(system), row_(row), friction_(friction), smallest_size_(smallest_size), memory_(memory) {
    for (std::size_t i = 0; i < row_.size(); ++i) memory_.gathered[i] = memory_.impulse[row_[i]];
}

void BlockOperator::refresh() {
    for (std::size_t i = 0; i < row_.size(); ++i) memory_.impulse[row_[i]] = memory_.gathered[i];
}

Vec3 BlockOperator::add_products(Index row, Vec3 start) const {
    for (Index k = system_.row_offset[row]; k < system_.row_offset[row + 1]; ++k)
        start.noalias() += system_.block[k] * memory_.impulse[system_.column[k]];
    return start;
}

Real BlockOperator::step(Index i, Real relaxation) {
    const Index row = row_[i];
    const Real mu = system_.mu[row];
    const LocalBlock& local = memory_.local[row];
    const Vec3 u = velocity(row);
    const Vec3 before = memory_.impulse[row];
    Vec3 next;
    if (friction_ == Friction::pyramid) {
        next = step_pyramid(local.matrix, before, u, mu, relaxation);
    } else {
        next = solve_block(local, u - local.matrix * before, mu);
        if (relaxation != 1) next = project_coulomb(Vec3(before + relaxation * (next - before)), Vec3(Vec3::UnitX()), {mu, mu});
    }
    memory_.impulse[row] = next;
    memory_.gathered[i] = next;
    return (next - before).squaredNorm();
}

Real BlockOperator::error() const {
    Real lack = 0, q = 0, r = 0, u = 0;
    for (const Index row : row_) {
        const Vec3 velocity_now = velocity(row);
        const Vec3& impulse_now = memory_.impulse[row];
        lack += natural_map(impulse_now, velocity_now, system_.mu[row], friction_).squaredNorm();
        q += system_.q[row].squaredNorm();
        r += impulse_now.squaredNorm();
        u += velocity_now.squaredNorm();
    }
    if (lack == 0) return 0;
    const Real size = std::max({q, r, u, smallest_size_ * smallest_size_});
    return std::sqrt(lack / size);
}

void BlockOperator::residual(std::span<Vec3> out) const {
    for (std::size_t i = 0; i < row_.size(); ++i) out[i] = -velocity(row_[i]);
}

void BlockOperator::multiply(std::span<const Vec3> in, std::span<Vec3> out) {
    // through the system's impulses, since rows refer to contacts of the system; put back afterwards
    for (std::size_t i = 0; i < row_.size(); ++i) memory_.impulse[row_[i]] = in[i];
    for (std::size_t i = 0; i < row_.size(); ++i) out[i] = add_products(row_[i], Vec3::Zero());
    for (std::size_t i = 0; i < row_.size(); ++i) memory_.impulse[row_[i]] = memory_.gathered[i];
}

Vec3 BlockOperator::project(Index i, const Vec3& impulse) const {
    const Real mu = system_.mu[row_[i]];
    if (friction_ == Friction::pyramid) return clamp_to_pyramid(impulse, mu);
    return project_coulomb(impulse, Vec3(Vec3::UnitX()), {mu, mu});
}

Vec3 BlockOperator::feasible(Index i, const Vec3& residual) const {
    const Real mu = system_.mu[row_[i]];
    return feasible_direction(residual, memory_.gathered[i], Vec3(Vec3::UnitX()), {mu, mu}, friction_);
}

}  // namespace skerry
