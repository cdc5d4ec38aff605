#include "systems/solver/operators/lumped_operator.h"

#include <algorithm>
#include <cmath>

namespace skerry {

static_assert(ContactOperator<LumpedOperator>);

Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next, const SolverSettings& settings, Real h) {
    const Real gap = inputs.gap[row];
    const Real closing = gap < 0 ? 0 : gap / h;
    const Real restitution = inputs.restitution[row];
    if (restitution == 0) return closing;
    const Stencil& stencil = inputs.stencil[row];
    Vec3 before = -inputs.surface_velocity[row], coming = before;
    for (std::size_t a = 0; a < 4; ++a) {
        if (stencil.weight[a] == 0) continue;
        before += stencil.weight[a] * inputs.velocity[stencil.node[a]];
        coming += stencil.weight[a] * velocity_next[stencil.node[a]];
    }
    const Real approach = before.dot(inputs.normal[row]);
    // What is not clearly faster than what forces give it in one step is no impact (methods.md 1.3 b): weight alone gives g h to a resting
    // contact, and elastic forces can throw a node back down in each step, onto a floor that would throw it up again for ever.
    const Real thrown = std::abs(coming.dot(inputs.normal[row]) - approach);
    const Real slowest_impact = std::max({settings.restitution_speed, 2 * inputs.gravity * h, 2 * thrown});
    const bool impact = approach < -slowest_impact && gap + h * approach <= 0;
    return impact ? std::min(closing, restitution * approach) : closing;
}

Vec3 half_turn(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next) {
    if (inputs.dynamic_friction[row] == 0) return Vec3::Zero();
    const Stencil& stencil = inputs.stencil[row];
    Vec3 before = -inputs.surface_velocity[row], now = before;
    for (std::size_t a = 0; a < 4; ++a) {
        if (stencil.weight[a] == 0) continue;
        before += stencil.weight[a] * inputs.velocity[stencil.node[a]];
        now += stencil.weight[a] * velocity_next[stencil.node[a]];
    }
    const Vec3& normal = inputs.normal[row];
    const Vec3 slip_before = before - normal.dot(before) * normal, slip = now - normal.dot(now) * normal, turn = slip - slip_before;
    // What is about to stop or to turn back keeps the law as it is: it has no direction halfway. In between it fades, or a step would jump.
    const Real fading = 2 - 4 * turn.norm() / slip_before.norm();
    if (!(fading > 0) || turn.isZero(0)) return Vec3::Zero();
    return 0.5 * std::min(Real(1), fading) * (turn - (slip.dot(turn) / slip.squaredNorm()) * slip);
}

void LumpedOperator::refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const {
    for (std::size_t n = 0; n < memory_.node.size(); ++n) velocity[n] = padded(memory_.free_velocity[memory_.node[n]]);
    for (std::size_t i = 0; i < memory_.contact.size(); ++i) apply_impulse(memory_.contact[i], impulse[i], velocity.data());
}

void LumpedOperator::refresh_all() {
    refresh();
    refresh(memory_.workspace[1], memory_.scratch);  // one without the other lets their difference grow
}

void LumpedOperator::remember() {
    std::ranges::copy(memory_.impulse, memory_.workspace[1].begin());
    std::ranges::copy(memory_.velocity, memory_.scratch.begin());
}

void LumpedOperator::extrapolate(Real factor) {
    const auto move = [factor](std::span<Vec4> present, std::span<Vec4> previous) {
        for (std::size_t i = 0; i < present.size(); ++i) {
            const Vec4 now = present[i];
            present[i] = now + factor * (now - previous[i]);
            previous[i] = now;
        }
    };
    move(memory_.impulse, memory_.workspace[1]);
    move(memory_.velocity, memory_.scratch);  // velocities are affine in the impulses
}

Real LumpedOperator::step_unless_frozen(Index i, Real relaxation) {
    constexpr std::uint8_t sweeps_to_freeze = 2, sweeps_frozen = 8;  // methods.md 2.7
    std::uint8_t& resting = memory_.resting[i];
    if (resting >= sweeps_to_freeze && resting != velocity_unknown) {
        if (resting < sweeps_to_freeze + sweeps_frozen) {
            ++resting;
            ++frozen_;
            return 0;
        }
        resting = sweeps_to_freeze - 1;  // looked at once, then frozen again
    }
    const LumpedContact& contact = memory_.contact[i];
    const Vec4 u = contact_velocity(contact, memory_.velocity.data());
    const Vec4 moved = u - memory_.last_velocity[i];
    memory_.last_velocity[i] = u;
    const Real size = step(i, relaxation);
    const bool known = resting != velocity_unknown;
    const bool at_rest = known && size <= memory_.still && contact.inverse_diagonal * moved.squaredNorm() <= memory_.still;
    resting = at_rest ? static_cast<std::uint8_t>(resting + 1) : std::uint8_t{0};
    return size;
}

bool LumpedOperator::make_feasible() {
    bool changed = false;
    for (std::size_t i = 0; i < memory_.contact.size(); ++i) {
        const LumpedContact& contact = memory_.contact[i];
        const Vec4 inside = project_friction(memory_.impulse[i], contact.normal, contact.friction, friction_);
        const Vec4 change = inside - memory_.impulse[i];
        if (change.squaredNorm() == 0) continue;
        apply_impulse(contact, change, memory_.velocity.data());
        memory_.impulse[i] = inside;
        changed = true;
    }
    return changed;
}

Real LumpedOperator::error() {
    std::fill(memory_.resting.begin(), memory_.resting.end(), velocity_unknown);
    Real sum = 0;
    for (std::size_t i = 0; i < memory_.contact.size(); ++i) {
        const LumpedContact& contact = memory_.contact[i];
        if (contact.node_count == 0) continue;
        const Vec4 u = contact_velocity(contact, memory_.velocity.data());
        sum += contact.diagonal * natural_map(contact, friction_, memory_.impulse[i], u).squaredNorm();
    }
    if (sum == 0) return 0;  // solved exactly, whatever the scale
    return std::sqrt(sum) / scale_;
}

void LumpedOperator::residual(std::span<Vec4> out) const {
    for (std::size_t i = 0; i < memory_.contact.size(); ++i)
        out[i] =
            memory_.contact[i].node_count == 0 ? Vec4(Vec4::Zero()) : Vec4(-contact_velocity(memory_.contact[i], memory_.velocity.data()));
}

void LumpedOperator::multiply(std::span<const Vec4> in, std::span<Vec4> out) {
    std::fill(memory_.scratch.begin(), memory_.scratch.end(), Vec4::Zero());
    for (std::size_t i = 0; i < memory_.contact.size(); ++i) apply_impulse(memory_.contact[i], in[i], memory_.scratch.data());
    for (std::size_t i = 0; i < memory_.contact.size(); ++i)
        out[i] = add_node_velocities(memory_.contact[i], memory_.scratch.data(), Vec4::Zero());
}

void LumpedOperator::assemble(Eigen::MatrixXd& matrix) const {
    matrix.setZero(3 * size(), 3 * size());
    for (Index i = 0; i < size(); ++i)
        for (Index j = 0; j < size(); ++j) {
            const LumpedContact &a = memory_.contact[i], &b = memory_.contact[j];
            Real coupling = 0;
            for (Index k = 0; k < a.node_count; ++k)
                for (Index l = 0; l < b.node_count; ++l)
                    if (a.node[k] == b.node[l]) coupling += a.weight[k] * b.step[l];
            matrix.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(coupling);
        }
}

}  // namespace skerry
