// Delassus operator of lumped masses: every block is a scalar times the identity (docs/methods/contact.md 2.1). It
// carries the velocities of the region's moving nodes, so that one contact step is a gather and a scatter.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "components/options.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/local/push_contact.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/in_order.h"

namespace skerry {

/// Memory of one region, owned by the caller. Spans by contact are in the order of the walk. Most regions have one
/// velocity per node; regions with rigid bodies also have two per body.
struct ContactMemory {
    std::span<const LumpedContact> contact;
    std::span<Vec4> impulse;      // [N s]
    std::span<Vec4> velocity;     // includes the effect of the impulse [m/s, rad/s]
    std::span<const Index> node;  // by velocity: row of NodeTable, or no_index for that of a rigid body
    std::span<Vec4> scratch;      // by velocity: previous velocities, or those of a product
    std::array<std::span<Vec4>, workspace_limit> workspace;  // by contact
};

struct LumpedMemory : ContactMemory {
    std::span<const Vec3> free_velocity;  // by row of NodeTable [m/s]
};

/// For a given order of the contacts the bits of the impulses do not depend on the walk; those of sums do.
template <RegionWalk Walk>
class LumpedOperatorBy {
public:
    using Number = Real;

    /// `scale` is the scale of e_nat [sqrt(J)]. Velocities must match the impulse.
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
        refresh(memory_.workspace[1], memory_.scratch);  // refreshing only one would let their difference grow
    }
    void remember();
    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    /// e_nat of docs/methods/errors.md 2 over all contacts.
    Real error();
    /// The change of a sweep approximates the natural map at its start. The error is worth measuring once the change is
    /// small.
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }
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

    /// Velocity of a contact [m/s]
    Vec4 velocity(Index i) const { return contact_velocity(memory_.contact[i], memory_.velocity.data()); }
    /// Energy that stops a contact at this normal speed [J]
    Real push_size(Index i, Real speed) const { return memory_.contact[i].inverse_diagonal * speed * speed; }
    /// One contact step of the split impulse (push_contact.h). Returns the size of the change [J]
    Real push(Index i, Real bias, Vec4* velocity, Real& impulse) const {
        return push_contact(memory_.contact[i], bias, velocity, impulse, apply_by(walk_));
    }

private:
    /// Applies an extrapolation of the impulses that was postponed to the next sweep.
    void settle();
    static auto apply_by(const Walk& walk) {
        return [&walk](const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
            walk.apply(contact, impulse, velocity);
        };
    }
    /// The step of contact i. Copies everything it needs: the compiler must assume that a vector store changes any
    /// memory.
    auto step(Real relaxation) const {
        return [contact = memory_.contact.data(), velocity = memory_.velocity.data(), friction = friction_, relaxation,
                walk = walk_](std::size_t i, Vec4& impulse) {
            return solve_contact(contact[i], friction, relaxation, velocity, impulse, apply_by(walk));
        };
    }
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;

    LumpedMemory memory_;
    Friction friction_;
    Real scale_;
    Walk walk_;
    // An extrapolation of impulses is postponed to the next sweep, which visits them anyway. Its velocities are up to
    // date.
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
Real LumpedOperatorBy<Walk>::sweep(Real relaxation) {
    settle();
    return walk_.template sum<Real>(memory_.contact.size(),
                                    [this, step = step(relaxation)](std::size_t begin, std::size_t end) {
                                        const std::span<Vec4> impulse = memory_.impulse;
                                        Real change = 0;
                                        for (std::size_t i = begin; i < end; ++i) change += step(i, impulse[i]);
                                        return change;
                                    });
}

template <RegionWalk Walk>
SweepChange LumpedOperatorBy<Walk>::accelerated_sweep(Real relaxation) {
    const bool waiting = std::exchange(waiting_, false);
    return walk_.template sum<SweepChange>(
        memory_.contact.size(), [this, waiting, step = step(relaxation)](std::size_t begin, std::size_t end) {
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
Real LumpedOperatorBy<Walk>::error() {
    settle();
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
    if (sum == 0) return 0;  // solved exactly, for any scale
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
