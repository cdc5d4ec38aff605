// Shared functions of operators for regions in a step of the engine. These operators store the velocities that the
// impulses produce. So a contact step reads the velocities of the contact's nodes, solves the contact, and writes these
// velocities back.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "components/options.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/in_order.h"

namespace skerry {

/// Memory of one region, owned by the caller. Spans by contact are in the order of the traversal. A region has one
/// velocity row per node, plus two rows per rigid body.
struct ContactMemory {
    std::span<const LumpedContact> contact;
    std::span<Vec4> impulse;      // [N s]
    std::span<Vec4> velocity;     // velocities that include the effect of the impulse [m/s, rad/s]
    std::span<const Index> node;  // by velocity row: row of NodeTable, or no_index for rigid bodies
    std::span<Vec4> scratch;      // by velocity row: velocities for the previous impulses; multiply() overwrites them
    std::array<std::span<Vec4>, workspace_limit> workspace;  // by contact
};

/// Base class of operators. `Own` is the operator that derives from it. It adds sweeps and defines
/// - moves(): whether a contact can move anything,
/// - squared_residual(): the contact's term in the squared error,
/// - free_velocity(): velocity without impulses,
/// - add_response(): velocity change by impulses.
template <class Own, RegionOrder Traversal, class Memory>
class RegionOperatorBase {
public:
    using Number = Real;

    Index size() const { return static_cast<Index>(memory_.contact.size()); }
    std::span<Vec4> impulse() {
        own().settle();
        return memory_.impulse;
    }
    std::span<Vec4> workspace(Index slot) {
        own().settle();
        return memory_.workspace[slot];
    }
    void refresh() {
        own().settle();
        refresh(memory_.impulse, memory_.velocity);
    }
    void refresh_all() {
        refresh();
        // Refreshing only one of the two velocity arrays would let rounding errors in their difference grow.
        refresh(memory_.workspace[1], memory_.scratch);
    }
    void remember() {
        own().settle();
        traversal_.contacts(memory_.impulse.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) memory_.workspace[1][i] = memory_.impulse[i];
        });
        traversal_.nodes(memory_.velocity.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) memory_.scratch[n] = memory_.velocity[n];
        });
    }
    /// Relative error e_nat of the present impulses over all contacts (docs/methods/errors.md 2).
    Real error() {
        own().settle();
        const Real sum =
            traversal_.template sum<Real>(memory_.contact.size(), [this](std::size_t begin, std::size_t end) {
                Real part = 0;
                for (std::size_t i = begin; i < end; ++i)
                    if (own().moves(static_cast<Index>(i))) part += own().squared_residual(static_cast<Index>(i));
                return part;
            });
        // Near the underflow threshold, `sum` and scale_ have no accurate digits, and scale_ may be zero.
        constexpr Real least_energy = std::numeric_limits<Real>::min() / std::numeric_limits<Real>::epsilon();  // [J]
        if (sum < least_energy) return 0;
        return std::sqrt(sum) / scale_;
    }
    /// True if the error is worth measuring. A sweep changes the impulses approximately by the natural map at the start
    /// of the sweep, which is also the measure of the error. So a small change suggests a small error.
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }
    void residual(std::span<Vec4> out) {
        own().settle();
        traversal_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto at = static_cast<Index>(i);
                out[i] = own().moves(at) ? Vec4(-own().velocity(at)) : Vec4(Vec4::Zero());
            }
        });
    }
    void multiply(std::span<const Vec4> in, std::span<Vec4> out) {
        traversal_.nodes(memory_.scratch.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) memory_.scratch[n].setZero();
        });
        own().add_response(in, memory_.scratch);
        traversal_.contacts(memory_.contact.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                out[i] = own().velocity_at(static_cast<Index>(i), memory_.scratch.data());
        });
    }
    Vec4 feasible(Index i, const Vec4& residual) const {
        return feasible_direction(residual, memory_.impulse[i], contact(i).normal, contact(i).friction, friction_);
    }
    Vec4 normal(Index i) const { return contact(i).normal; }
    FrictionLimits limits(Index i) const { return contact(i).friction; }
    Real mobility(Index i) const { return own().moves(i) ? contact(i).diagonal : 0; }
    Friction law() const { return friction_; }

protected:
    RegionOperatorBase(const Memory& memory, Friction friction, Real scale, const Traversal& traversal)
        : memory_(memory), friction_(friction), scale_(scale), traversal_(traversal) {}

    const LumpedContact& contact(Index i) const { return memory_.contact[i]; }
    /// Applies a postponed extrapolation. Operators that postpone extrapolations hide this function.
    void settle() {}
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) {
        traversal_.nodes(memory_.node.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) velocity[n] = own().free_velocity(n);
        });
        own().add_response(impulse, velocity);
    }

    Memory memory_;
    Friction friction_;
    Real scale_;  // number by which the error e_nat is divided [sqrt(J)]
    Traversal traversal_;

private:
    Own& own() { return static_cast<Own&>(*this); }
    const Own& own() const { return static_cast<const Own&>(*this); }
};

}  // namespace skerry
