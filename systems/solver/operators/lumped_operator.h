// The Delassus operator of lumped masses: every block is a number times the identity (docs/methods/contact.md 2.1). It
// carries the velocities of the region's moving nodes, so that one contact step is a gather and a scatter.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "components/options.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/in_order.h"

namespace skerry {

/// A contact that has not been looked at since the last measure of the error: its last velocity says nothing.
inline constexpr std::uint8_t velocity_unknown = 255;

/// One region; by contact: in the order of the walk. The memory belongs to the caller.
struct LumpedMemory {
    std::span<const LumpedContact> contact;
    std::span<Vec4> impulse;              // N s
    std::span<Vec4> velocity;             // m/s, of the region's nodes, moved by the impulse
    std::span<const Index> node;          // rows of NodeTable
    std::span<const Vec3> free_velocity;  // m/s, by row of NodeTable
    // by node of the region: previous velocities, or those of a product
    std::span<Vec4> scratch;
    std::array<std::span<Vec4>, workspace_limit> workspace;  // by contact
    // by contact: sweeps without a change, at first velocity_unknown. None: no contact is frozen
    std::span<std::uint8_t> quiet_sweeps{};
    std::span<Vec4> last_velocity{};  // m/s, by contact, while one may rest
    Real still = 0;                   // J, a smaller change is none
};

/// The bits of the impulses do not depend on the walk, given the order of the contacts; those of sums do.
template <RegionWalk Walk>
class LumpedOperatorBy {
public:
    using Number = Real;

    /// `scale` is that of e_nat: sqrt(J). Velocities must be those of the impulse.
    LumpedOperatorBy(const LumpedMemory& memory, Friction friction, Real scale, const Walk& walk = {})
        : memory_(memory), friction_(friction), scale_(scale), walk_(walk) {}

    Index size() const { return static_cast<Index>(memory_.contact.size()); }
    std::span<Vec4> impulse() {
        settle();
        return memory_.impulse;
    }
    std::span<Vec4> workspace(Index slot) {
        settle();
        return memory_.workspace[slot];
    }
    void refresh() {
        settle();
        refresh(memory_.impulse, memory_.velocity);
    }
    void refresh_all() {
        refresh();
        refresh(memory_.workspace[1], memory_.scratch);  // one without the other lets their difference grow
    }
    void remember();
    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    /// e_nat of docs/methods/errors.md 2, of all contacts: frozen ones are looked at, and go on.
    Real error();
    /// Contact steps left out so far.
    Index frozen() const { return frozen_; }
    /// Puts every impulse into its cone: the acceleration carries those of frozen contacts on without one. Returns
    /// whether any was outside.
    bool make_feasible() requires Walk::one_thread;
    /// A sweep's change is about the natural map of its start: worth a look once it is as small.
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }
    Real inner(Index i, const Vec4& a, const Vec4& b) const { return memory_.contact[i].diagonal * a.dot(b); }
    void residual(std::span<Vec4> out);
    void multiply(std::span<const Vec4> in, std::span<Vec4> out);
    Vec4 project(Index i, const Vec4& impulse) const {
        return project_friction(impulse, memory_.contact[i].normal, memory_.contact[i].friction, friction_);
    }
    Vec4 feasible(Index i, const Vec4& residual) const {
        return feasible_direction(residual, memory_.impulse[i], memory_.contact[i].normal, memory_.contact[i].friction,
                                  friction_);
    }
    Vec4 normal(Index i) const { return memory_.contact[i].normal; }
    FrictionLimits limits(Index i) const { return memory_.contact[i].friction; }
    Real mobility(Index i) const { return memory_.contact[i].node_count > 0 ? memory_.contact[i].diagonal : 0; }
    Friction law() const { return friction_; }
    void assemble(Eigen::MatrixXd& matrix) const;

private:
    /// Does now what waits for a next sweep.
    void settle();
    static auto apply_by(const Walk& walk) {
        return [&walk](const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
            walk.apply(contact, impulse, velocity);
        };
    }
    /// Counts the sweep. The first ones are not worth the bookkeeping: most solves end with them.
    bool may_freeze() {
        constexpr Index first_sweeps = 8;  // docs/solvers.md, "Constants"
        return Walk::one_thread && !memory_.quiet_sweeps.empty() && ++sweeps_ > first_sweeps;
    }
    /// The step of contact i, with copies of all it needs: a store of vectors may change whatever is in memory.
    auto step(Real relaxation) const {
        return [contact = memory_.contact.data(), velocity = memory_.velocity.data(), friction = friction_, relaxation,
                walk = walk_](std::size_t i, Vec4& impulse) {
            return solve_contact(contact[i], friction, relaxation, velocity, impulse, apply_by(walk));
        };
    }
    Real step_unless_frozen(std::size_t i, Real relaxation, Vec4& impulse);
    auto step_unless_frozen(Real relaxation) {
        return [this, relaxation](std::size_t i, Vec4& impulse) { return step_unless_frozen(i, relaxation, impulse); };
    }
    template <class Step>
    Real sweep_with(const Step& step);
    template <class Step>
    SweepChange accelerated_sweep_with(const Step& step);
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;

    LumpedMemory memory_;
    Friction friction_;
    Real scale_;
    Walk walk_;
    Index sweeps_ = 0, frozen_ = 0;
    // The impulses of an extrapolation wait for the next sweep, which passes over them anyway; its velocities are done.
    bool waiting_ = false;
    Real factor_ = 0;
};

using LumpedOperator = LumpedOperatorBy<InOrder>;

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::settle() {
    if (!waiting_) return;
    waiting_ = false;
    walk_.contacts(memory_.impulse.size(), [this](std::size_t begin, std::size_t end) {
        extrapolate_range(begin, end, factor_, memory_.impulse, memory_.workspace[1]);
    });
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::remember() {
    settle();
    walk_.contacts(memory_.impulse.size(), [this](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) memory_.workspace[1][i] = memory_.impulse[i];
    });
    walk_.nodes(memory_.velocity.size(), [this](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) memory_.scratch[n] = memory_.velocity[n];
    });
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::extrapolate(Real factor) {
    settle();
    // velocities are affine in the impulses
    walk_.nodes(memory_.velocity.size(), [this, factor](std::size_t begin, std::size_t end) {
        extrapolate_range(begin, end, factor, memory_.velocity, memory_.scratch);
    });
    waiting_ = true;
    factor_ = factor;
}

template <RegionWalk Walk>
template <class Step>
Real LumpedOperatorBy<Walk>::sweep_with(const Step& step) {
    return walk_.template sum<Real>(memory_.contact.size(), [this, step](std::size_t begin, std::size_t end) {
        const std::span<Vec4> impulse = memory_.impulse;
        Real change = 0;
        for (std::size_t i = begin; i < end; ++i) change += step(i, impulse[i]);
        return change;
    });
}

template <RegionWalk Walk>
Real LumpedOperatorBy<Walk>::sweep(Real relaxation) {
    settle();
    return may_freeze() ? sweep_with(step_unless_frozen(relaxation)) : sweep_with(step(relaxation));
}

template <RegionWalk Walk>
template <class Step>
SweepChange LumpedOperatorBy<Walk>::accelerated_sweep_with(const Step& step) {
    const bool waiting = std::exchange(waiting_, false);
    return walk_.template sum<SweepChange>(memory_.contact.size(), [=, this](std::size_t begin, std::size_t end) {
        const std::span<const LumpedContact> contact = memory_.contact;
        const std::span<Vec4> impulse = memory_.impulse, previous = memory_.workspace[1];
        const Real factor = factor_;
        SweepChange sum;
        for (std::size_t i = begin; i < end; ++i) {
            if (waiting) extrapolate_one(factor, impulse[i], previous[i]);
            const Vec4 before = impulse[i];
            const Real size = step(i, impulse[i]);
            if (size == 0) continue;
            sum.size += size;
            sum.against -= contact[i].diagonal * (impulse[i] - before).dot(impulse[i] - previous[i]);
        }
        return sum;
    });
}

template <RegionWalk Walk>
SweepChange LumpedOperatorBy<Walk>::accelerated_sweep(Real relaxation) {
    return may_freeze() ? accelerated_sweep_with(step_unless_frozen(relaxation))
                        : accelerated_sweep_with(step(relaxation));
}

template <RegionWalk Walk>
Real LumpedOperatorBy<Walk>::step_unless_frozen(std::size_t i, Real relaxation, Vec4& impulse) {
    constexpr std::uint8_t sweeps_to_freeze = 2, sweeps_frozen = 8;  // docs/solvers.md, "Constants"
    std::uint8_t& quiet_sweeps = memory_.quiet_sweeps[i];
    if (quiet_sweeps >= sweeps_to_freeze && quiet_sweeps != velocity_unknown) {
        if (quiet_sweeps < sweeps_to_freeze + sweeps_frozen) {
            ++quiet_sweeps;
            ++frozen_;
            return 0;
        }
        quiet_sweeps = sweeps_to_freeze - 1;  // looked at once, then frozen again
    }
    const LumpedContact& contact = memory_.contact[i];
    const Vec4 u = contact_velocity(contact, memory_.velocity.data());
    const Vec4 moved = u - memory_.last_velocity[i];
    memory_.last_velocity[i] = u;
    const Real size = solve_contact(contact, friction_, relaxation, memory_.velocity.data(), impulse, apply_by(walk_));
    const bool known = quiet_sweeps != velocity_unknown;
    const bool at_rest =
        known && size <= memory_.still && contact.inverse_diagonal * moved.squaredNorm() <= memory_.still;
    quiet_sweeps = at_rest ? static_cast<std::uint8_t>(quiet_sweeps + 1) : std::uint8_t{0};
    return size;
}

template <RegionWalk Walk>
bool LumpedOperatorBy<Walk>::make_feasible() requires Walk::one_thread {
    settle();
    bool changed = false;
    for (std::size_t i = 0; i < memory_.contact.size(); ++i) {
        const LumpedContact& contact = memory_.contact[i];
        const Vec4 inside = project_friction(memory_.impulse[i], contact.normal, contact.friction, friction_);
        const Vec4 change = inside - memory_.impulse[i];
        if (change.squaredNorm() == 0) continue;
        walk_.apply(contact, change, memory_.velocity.data());
        memory_.impulse[i] = inside;
        changed = true;
    }
    return changed;
}

template <RegionWalk Walk>
Real LumpedOperatorBy<Walk>::error() {
    settle();
    std::fill(memory_.quiet_sweeps.begin(), memory_.quiet_sweeps.end(), velocity_unknown);
    const Real sum = walk_.template sum<Real>(memory_.contact.size(), [this](std::size_t begin, std::size_t end) {
        Real part = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = memory_.contact[i];
            if (contact.node_count == 0) continue;
            const Vec4 u = contact_velocity(contact, memory_.velocity.data());
            part += contact.diagonal * natural_map(contact, friction_, memory_.impulse[i], u).squaredNorm();
        }
        return part;
    });
    if (sum == 0) return 0;  // solved exactly, whatever the scale
    return std::sqrt(sum) / scale_;
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const {
    walk_.nodes(memory_.node.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) velocity[n] = padded(memory_.free_velocity[memory_.node[n]]);
    });
    walk_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) walk_.apply(memory_.contact[i], impulse[i], velocity.data());
    });
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::residual(std::span<Vec4> out) {
    settle();
    walk_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = memory_.contact[i];
            out[i] = contact.node_count == 0 ? Vec4(Vec4::Zero())
                                             : Vec4(-contact_velocity(contact, memory_.velocity.data()));
        }
    });
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::multiply(std::span<const Vec4> in, std::span<Vec4> out) {
    walk_.nodes(memory_.scratch.size(), [this](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) memory_.scratch[n].setZero();
    });
    walk_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) walk_.apply(memory_.contact[i], in[i], memory_.scratch.data());
    });
    walk_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            out[i] = add_node_velocities(memory_.contact[i], memory_.scratch.data(), Vec4::Zero());
    });
}

template <RegionWalk Walk>
void LumpedOperatorBy<Walk>::assemble(Eigen::MatrixXd& matrix) const {
    matrix.setZero(3 * size(), 3 * size());
    for (Index i = 0; i < size(); ++i)
        for (Index j = 0; j < size(); ++j) {
            const LumpedContact &a = memory_.contact[i], &b = memory_.contact[j];
            matrix.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(walk_.coupling(a, b));
        }
}

static_assert(ContactOperator<LumpedOperator>);
extern template class LumpedOperatorBy<InOrder>;  // compiled once, in lumped_operator.cpp

}  // namespace skerry
