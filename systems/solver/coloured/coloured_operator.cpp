#include "systems/solver/coloured/coloured_operator.h"

#include <cmath>

namespace skerry {

static_assert(ContactOperator<ColouredOperator>);

namespace {

inline void extrapolate_one(Real factor, Vec4& present, Vec4& previous) {
    const Vec4 now = present;
    present = now + factor * (now - previous);
    previous = now;
}

}  // namespace

void ColouredOperator::settle() {
    if (!waiting_) return;
    waiting_ = false;
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) extrapolate_one(factor_, memory_.impulse[i], memory_.workspace[1][i]);
    });
}

void ColouredOperator::extrapolate(Real factor) {
    settle();
    for_row_blocks(team_, memory_.velocity.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) extrapolate_one(factor, memory_.velocity[n], memory_.scratch[n]);
    });
    waiting_ = true;
    factor_ = factor;
}

Real ColouredOperator::sweep(Real relaxation) {
    settle();
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index block) {
        Real change = 0;
        for (std::size_t i = begin; i < end; ++i)
            change += solve_contact(memory_.contact[i], friction_, relaxation, memory_.velocity.data(), memory_.impulse[i]);
        partial_[block].size = change;
    });
    Real sum = 0;
    for (std::size_t b = 0; b + 1 < order_.block_offset.size(); ++b) sum += partial_[b].size;
    return sum;
}

SweepChange ColouredOperator::accelerated_sweep(Real relaxation) {
    const bool waiting = waiting_;
    waiting_ = false;
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index block) {
        const std::span<const LumpedContact> contact = memory_.contact;
        const std::span<Vec4> impulse = memory_.impulse, previous = memory_.workspace[1];
        SweepChange sum{0, 0};
        for (std::size_t i = begin; i < end; ++i) {
            if (waiting) extrapolate_one(factor_, impulse[i], previous[i]);
            const Vec4 before = impulse[i];
            const Real size = solve_contact(contact[i], friction_, relaxation, memory_.velocity.data(), impulse[i]);
            if (size == 0) continue;
            sum.size += size;
            sum.against -= contact[i].diagonal * (impulse[i] - before).dot(impulse[i] - previous[i]);
        }
        partial_[block] = sum;
    });
    SweepChange sum{0, 0};
    for (std::size_t b = 0; b + 1 < order_.block_offset.size(); ++b) {
        sum.size += partial_[b].size;
        sum.against += partial_[b].against;
    }
    return sum;
}

Real ColouredOperator::error() {
    settle();
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index block) {
        Real sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = memory_.contact[i];
            if (contact.node_count == 0) continue;
            const Vec4 u = contact_velocity(contact, memory_.velocity.data());
            sum += contact.diagonal * natural_map(contact, friction_, memory_.impulse[i], u).squaredNorm();
        }
        partial_[block].size = sum;
    });
    Real sum = 0;
    for (std::size_t b = 0; b + 1 < order_.block_offset.size(); ++b) sum += partial_[b].size;
    return sum == 0 ? 0 : std::sqrt(sum) / scale_;
}

void ColouredOperator::remember() {
    settle();
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) memory_.workspace[1][i] = memory_.impulse[i];
    });
    for_row_blocks(team_, memory_.velocity.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) memory_.scratch[n] = memory_.velocity[n];
    });
}

void ColouredOperator::refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) {
    for_row_blocks(team_, memory_.node.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) velocity[n] = padded(memory_.free_velocity[memory_.node[n]]);
    });
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) apply_impulse(memory_.contact[i], impulse[i], velocity.data());
    });
}

void ColouredOperator::refresh_all() {
    refresh();
    refresh(memory_.workspace[1], memory_.scratch);  // one without the other lets their difference grow
}

void ColouredOperator::residual(std::span<Vec4> out) {
    settle();
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = memory_.contact[i];
            out[i] = contact.node_count == 0 ? Vec4(Vec4::Zero()) : Vec4(-contact_velocity(contact, memory_.velocity.data()));
        }
    });
}

void ColouredOperator::multiply(std::span<const Vec4> in, std::span<Vec4> out) {
    for_row_blocks(team_, memory_.node.size(), [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t n = begin; n < end; ++n) memory_.scratch[n].setZero();
    });
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) apply_impulse(memory_.contact[i], in[i], memory_.scratch.data());
    });
    for_ordered_blocks(team_, order_, [&](std::size_t begin, std::size_t end, Index) {
        for (std::size_t i = begin; i < end; ++i) out[i] = add_node_velocities(memory_.contact[i], memory_.scratch.data(), Vec4::Zero());
    });
}

}  // namespace skerry
