// Delassus operator for lumped masses: every 3x3 block is a scalar times the identity (docs/methods/contact.md 2.1).
#pragma once

#include <span>
#include <utility>

#include "systems/solver/local/push_contact.h"
#include "systems/solver/operators/region_operator.h"

namespace skerry {

struct LumpedMemory : ContactMemory {
    std::span<const Vec3> free_velocity;  // by row of NodeTable: velocity without impulses [m/s]
};

/// Operator of a region with lumped masses. For a given order of the contacts, the bits of the impulses do not depend
/// on the type of the traversal. The bits of sums over contacts (error, squared change of a sweep) do, because each
/// traversal adds in its own order.
template <RegionTraversal Traversal>
class LumpedOperatorBy : public RegionOperatorBase<LumpedOperatorBy<Traversal>, Traversal, LumpedMemory> {
    using Base = RegionOperatorBase<LumpedOperatorBy<Traversal>, Traversal, LumpedMemory>;
    friend Base;

public:
    using Base::size;

    /// The error e_nat is divided by `scale` [sqrt(J)]. The velocities in `memory` must be those that its impulses
    /// produce.
    LumpedOperatorBy(const LumpedMemory& memory, Friction friction, Real scale, const Traversal& traversal = {})
        : Base(memory, friction, scale, traversal) {}

    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    Vec4 project(Index i, const Vec4& impulse) const {
        return project_friction(impulse, contact(i).normal, contact(i).friction, friction_);
    }
    void assemble(Eigen::MatrixXd& matrix) const;

    /// Velocity of a contact [m/s]
    Vec4 velocity(Index i) const { return contact_velocity(contact(i), memory_.velocity.data()); }
    /// Squared energy norm of the impulse that changes the normal speed of a contact by `speed` [J]
    Real push_size(Index i, Real speed) const { return contact(i).inverse_diagonal * speed * speed; }
    /// Gauss-Seidel step of the split impulse for contact i (push_contact.h). Changes the pseudo velocities `velocity`
    /// and the push impulse `impulse`. Returns the squared energy norm of the change of the impulse [J]
    Real push(Index i, Real bias, Vec4* velocity, Real& impulse) const {
        return push_contact(contact(i), bias, velocity, impulse, apply_by(traversal_));
    }

private:
    using Base::contact;
    using Base::friction_;
    using Base::memory_;
    using Base::traversal_;

    // Functions that the base class calls.
    bool moves(Index i) const { return contact(i).node_count > 0; }
    Real squared_residual(Index i) const {
        return contact(i).diagonal * natural_map(contact(i), friction_, memory_.impulse[i], velocity(i)).squaredNorm();
    }
    Vec4 free_velocity(std::size_t n) const { return padded(memory_.free_velocity[memory_.node[n]]); }
    Vec4 velocity_at(Index i, const Vec4* velocity) const {
        return add_node_velocities(contact(i), velocity, Vec4::Zero());
    }
    void add_response(std::span<const Vec4> impulse, std::span<Vec4> velocity) const {
        traversal_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) traversal_.apply(memory_.contact[i], impulse[i], velocity.data());
        });
    }
    void settle();

    static auto apply_by(const Traversal& traversal) {
        return [&traversal](const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
            traversal.apply(contact, impulse, velocity);
        };
    }
    /// Returns a function that solves contact i. It holds copies of all pointers and constants: otherwise the compiler
    /// must reload them after each vector store.
    auto step(Real relaxation) const {
        return [contact = memory_.contact.data(), velocity = memory_.velocity.data(), friction = friction_, relaxation,
                traversal = traversal_](std::size_t i, Vec4& impulse) {
            return solve_contact(contact[i], friction, relaxation, velocity, impulse, apply_by(traversal));
        };
    }

    // extrapolate() extrapolates the velocities at once, but postpones the impulses. While `waiting_` is true, they
    // still have to be extrapolated by `factor_`. The next sweep does it, because it visits the impulses anyway.
    bool waiting_ = false;
    Real factor_ = 0;
};

using LumpedOperator = LumpedOperatorBy<InOrder>;

template <RegionTraversal Traversal>
void LumpedOperatorBy<Traversal>::settle() {
    if (!waiting_) return;
    waiting_ = false;
    traversal_.contacts(memory_.impulse.size(), [this](std::size_t begin, std::size_t end) {
        extrapolate_range(begin, end, factor_, memory_.impulse, memory_.workspace[1]);
    });
}

template <RegionTraversal Traversal>
void LumpedOperatorBy<Traversal>::extrapolate(Real factor) {
    settle();
    // Velocities are an affine function of the impulses. If both are extrapolated by the same factor, the velocities
    // remain those that the impulses produce.
    traversal_.nodes(memory_.velocity.size(), [this, factor](std::size_t begin, std::size_t end) {
        extrapolate_range(begin, end, factor, memory_.velocity, memory_.scratch);
    });
    waiting_ = true;
    factor_ = factor;
}

template <RegionTraversal Traversal>
Real LumpedOperatorBy<Traversal>::sweep(Real relaxation) {
    settle();
    return traversal_.template sum<Real>(memory_.contact.size(),
                                         [this, step = step(relaxation)](std::size_t begin, std::size_t end) {
                                             const std::span<Vec4> impulse = memory_.impulse;
                                             Real change = 0;
                                             for (std::size_t i = begin; i < end; ++i) change += step(i, impulse[i]);
                                             return change;
                                         });
}

template <RegionTraversal Traversal>
SweepChange LumpedOperatorBy<Traversal>::accelerated_sweep(Real relaxation) {
    const bool waiting = std::exchange(waiting_, false);
    return traversal_.template sum<SweepChange>(
        memory_.contact.size(), [this, waiting, step = step(relaxation)](std::size_t begin, std::size_t end) {
            const std::span<const LumpedContact> contacts = memory_.contact;
            const std::span<Vec4> impulse = memory_.impulse, previous = memory_.workspace[1];
            const Real factor = factor_;
            SweepChange sum;
            for (std::size_t i = begin; i < end; ++i) {
                if (waiting) extrapolate_one(factor, impulse[i], previous[i]);
                const Vec4 before = impulse[i];
                const Real moved = step(i, impulse[i]);
                if (moved == 0) continue;
                sum.squared_change += moved;
                sum.reversal -= contacts[i].diagonal * (impulse[i] - before).dot(impulse[i] - previous[i]);
            }
            return sum;
        });
}

template <RegionTraversal Traversal>
void LumpedOperatorBy<Traversal>::assemble(Eigen::MatrixXd& matrix) const {
    matrix.setZero(3 * size(), 3 * size());
    for (Index i = 0; i < size(); ++i)
        for (Index j = 0; j < size(); ++j) {
            const LumpedContact &a = memory_.contact[i], &b = memory_.contact[j];
            matrix.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(traversal_.coupling(a, b));
        }
}

static_assert(ContactOperator<LumpedOperator>);
// These templates are instantiated once, in lumped_operator.cpp.
extern template class RegionOperatorBase<LumpedOperator, InOrder, LumpedMemory>;
extern template class LumpedOperatorBy<InOrder>;

}  // namespace skerry
