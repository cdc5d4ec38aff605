// Operator of a region without friction: one scalar row per contact (docs/methods/region_solver.md 4). The iteration
// uses only the normal impulses. It needs a third of the data and no projection onto a cone.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Normal impulses by contact: present and previous iterate [N s]
struct NormalMemory {
    std::span<Real> impulse, previous;
};

/// The constructor reads region.impulse, which must point along the normals. keep() writes the normal impulses back to
/// region.impulse.
class NormalRows {
public:
    using Number = Real;

    NormalRows(const LumpedMemory& region, Real scale, const NormalMemory& memory)
        : region_(region), memory_(memory), scale_(scale) {
        read_impulses();
    }

    SweepChange accelerated_sweep(Real relaxation) {
        const std::span<const LumpedContact> contacts = region_.contact;
        const std::span<Real> impulse = memory_.impulse, previous = memory_.previous;
        Vec4* velocity = region_.velocity.data();
        SweepChange sum;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const LumpedContact& contact = contacts[i];
            const Real next = unclamped(contact, impulse[i], relaxation, velocity), change = next - impulse[i];
            if (change == 0) continue;
            apply_impulse(contact, change * contact.normal, velocity);
            impulse[i] = next;
            sum.squared_change += contact.diagonal * change * change;
            sum.reversal -= contact.diagonal * change * (next - previous[i]);
        }
        return sum;
    }

    /// Relative error e_nat of the present impulses (docs/methods/errors.md 2).
    Real error() const {
        Real sum = 0;
        for (std::size_t i = 0; i < region_.contact.size(); ++i) {
            const Real present = memory_.impulse[i],
                       rest = present - unclamped(region_.contact[i], present, 1, region_.velocity.data());
            sum += region_.contact[i].diagonal * rest * rest;
        }
        return sum == 0 ? 0 : std::sqrt(sum) / scale_;
    }
    /// True if a sweep with this squared change suggests that the error is within the tolerance.
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }

    void remember() {
        std::ranges::copy(memory_.impulse, memory_.previous.begin());
        std::ranges::copy(region_.velocity, region_.scratch.begin());
    }
    void extrapolate(Real factor) {
        extrapolate_range(0, memory_.impulse.size(), factor, memory_.impulse, memory_.previous);
        // Velocities are an affine function of the impulses. If both are extrapolated by the same factor, the
        // velocities remain those that the impulses produce.
        extrapolate_range(0, region_.velocity.size(), factor, region_.velocity, region_.scratch);
    }
    /// Recomputes the velocities from the impulses, so that rounding errors of extrapolations do not accumulate.
    void refresh_all() {
        refresh(memory_.impulse, region_.velocity);
        refresh(memory_.previous, region_.scratch);
    }

    /// Copies the present impulses to region.impulse, which holds the best iterate.
    void keep() {
        for (std::size_t i = 0; i < region_.contact.size(); ++i)
            region_.impulse[i] = memory_.impulse[i] * region_.contact[i].normal;
    }
    /// Restores the impulses stored by keep() and recomputes the velocities.
    void restore() {
        read_impulses();
        refresh(memory_.impulse, region_.velocity);
    }

private:
    static Real unclamped(const LumpedContact& contact, Real impulse, Real relaxation, const Vec4* velocity) {
        const Real approach = contact.normal.dot(contact_velocity(contact, velocity));
        const Real next = impulse - relaxation * contact.inverse_diagonal * approach;
        return next <= 0 ? 0 : next;  // with this form of the comparison NaN stays NaN
    }
    void read_impulses() {
        for (std::size_t i = 0; i < region_.contact.size(); ++i)
            memory_.impulse[i] = region_.contact[i].normal.dot(region_.impulse[i]);
    }
    void refresh(std::span<const Real> impulse, std::span<Vec4> velocity) const {
        for (std::size_t n = 0; n < region_.node.size(); ++n)
            velocity[n] = padded(region_.free_velocity[region_.node[n]]);
        for (std::size_t i = 0; i < region_.contact.size(); ++i)
            apply_impulse(region_.contact[i], impulse[i] * region_.contact[i].normal, velocity.data());
    }

    LumpedMemory region_;
    NormalMemory memory_;
    Real scale_;
};

static_assert(SweptOperator<NormalRows>);

}  // namespace skerry
