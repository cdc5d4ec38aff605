// Split impulse of a region: separates penetrating contacts without adding energy (docs/methods/contact.md 3.4).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <span>
#include <utility>

#include "systems/solver/methods/acceleration.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Operator of a region. In addition to the functions that solver methods call (ContactOperator), it has those of the
/// split impulse.
template <class Op>
concept RegionOperator = ContactOperator<Op> &&
    requires(const Op& op, Index i, Real number, Vec4* velocity, Real& impulse) {
    { op.velocity(i) } -> std::same_as<Vec4>;  // velocity u of contact i for the present impulse
    // squared energy norm [J] of the impulse that changes the normal speed of contact i by `number` [m/s]
    { op.push_size(i, number) } -> std::same_as<Real>;
    // One contact step of the split impulse, which changes the pseudo velocities.
    { op.push(i, number, velocity, impulse) } -> std::same_as<Real>;
};

/// Parts of the split impulse that do not come from contacts. Regions of lumped masses have none. PushedBodies adds
/// joints and the rotation of capsules and cylinders.
struct PushedContacts {
    /// True if rotation of bodies may reduce gaps.
    bool any_rotation() const { return false; }
    /// Rate of change of a contact's gap because a rotating body moves the contact point on an arc instead of a
    /// straight line; 0 if the arc does not shrink the gap. It is never positive [m/s]
    Real loss(std::size_t, std::span<const Vec4>) const { return 0; }
    /// Does one sweep over the joints. Returns the change of their impulses [J]
    SweepChange sweep_joints(std::span<Vec4>) const { return {}; }
    /// Stores the present impulses of the joints as the previous ones.
    void remember() const {}
    void extrapolate(Real) const {}
};

/// Result of the split impulse of a region.
struct PushOutcome {
    bool any = false;  // false: all pseudo velocities are zero
    // Error of a push that reached the iteration limit: energy norm of the change of its last sweep, relative to that
    // of a push of all contacts at recovery_speed. 0 if the sweeps converged.
    Real error = 0;
};

/// Solver for the split impulse of one region. `Others` is PushedContacts or PushedBodies.
template <class Region, RegionOperator Op, class Others>
class Push {
public:
    Push(const RegionStage& stage, const Region& region, const Op& op, Others others)
        : stage_(stage),
          region_(region),
          op_(op),
          others_(std::move(others)),
          memory_(push_memory(stage, region.base, region.row.size())),
          velocity_(region.memory.scratch),
          velocity_before_(region.memory.push_before),
          slop_(push_slop(stage.inputs.gravity, stage.h)) {}

    /// Computes the pseudo velocities. `pressed`: true if some contact penetrates by more than the slop, the depth up
    /// to which penetrations are not corrected.
    PushOutcome run(bool pressed) {
        clear();
        const Requested requested = request();
        if (!pressed && !requested.by_rotation) return {};
        Real left = sweep(requested.size);
        // The push rotates bodies, and rotation changes the gaps of contacts. So the loss of gap is computed again with
        // the new rotation, and more sweeps compensate for it. This is done `rotation_rounds` times.
        constexpr int rotation_rounds = 2;
        for (int round = 0; round < rotation_rounds && others_.any_rotation(); ++round) left = sweep(request().size);
        return {true, left > 0 ? std::sqrt(left / size_of_pushes(stage_.settings.recovery_speed)) : 0};
    }

private:
    struct Requested {
        Real size;  // sum of the squared energy norms of all requested pushes [J]
        bool by_rotation;
    };

    void clear() {
        region_.traversal.nodes(velocity_.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) velocity_[n].setZero();
        });
        region_.traversal.contacts(region_.row.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) memory_.impulse[i] = 0;
        });
    }

    Requested request() {
        // Only regions that one thread solves have capsules or cylinders, so no two threads write this flag.
        bool by_rotation = false;
        const Real size =
            region_.traversal.template sum<Real>(region_.row.size(), [&](std::size_t begin, std::size_t end) {
                Real part = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    const LumpedContact& contact = region_.memory.contact[i];
                    const Real along = contact.normal.dot(op_.velocity(static_cast<Index>(i))) - contact.bias;
                    const Real gap = stage_.inputs.gap[region_.row_at(i)];
                    Real& bias = memory_.bias[i];
                    bias = push_bias(along, gap, slop_, stage_.settings, stage_.inputs.gravity, stage_.h);
                    if (const Real loss = others_.loss(i, velocity_); loss < 0) {
                        bias = push_bias_turned(bias, along, gap, slop_, loss, stage_.h);
                        by_rotation = by_rotation || bias < 0;
                    }
                    part += op_.push_size(static_cast<Index>(i), std::min(bias, Real(0)));
                }
                return part;
            });
        return {size, by_rotation};
    }

    /// Squared energy norm of pushes that change the normal speeds of all contacts by `speed` [J]
    Real size_of_pushes(Real speed) const {
        return region_.traversal.template sum<Real>(region_.row.size(), [&](std::size_t begin, std::size_t end) {
            Real size = 0;
            for (std::size_t i = begin; i < end; ++i) size += op_.push_size(static_cast<Index>(i), speed);
            return size;
        });
    }

    /// Sweeps until the pushes of the squared energy norm `requested` are reached. Returns 0 if the sweeps converged,
    /// otherwise the squared energy norm of the change of the last sweep [J]
    Real sweep(Real requested) {
        constexpr Real rounding = 1e-24;  // square of the relative tolerance 1e-12
        largest_request_ = std::max(largest_request_, requested);
        const Real least = rounding * largest_request_;
        const Real left = sweep_rows(std::max(region_.tolerance * region_.tolerance * requested, least), false);
        if (left == 0) return 0;
        // Joints and ties can prevent contacts from being pushed apart, so that the sweeps do not converge. The last
        // sweeps then visit only joints and ties: if their positions kept an error, the next velocity solve would
        // demand a motion that the contacts forbid.
        return std::max(left, sweep_rows(least, true));
    }

    /// Sweeps over the joints and contacts, or over the joints and ties only, until the squared energy norm of the
    /// change of a sweep is at most `small`. Returns 0 if this happens within max_iterations, otherwise the squared
    /// energy norm of the last change [J]
    Real sweep_rows(Real small, bool only_equations) {
        // Most pushes converge within this number of sweeps. Extrapolation, which takes time, serves the others, such
        // as those of a light body below a heavy one.
        constexpr Index plain_sweeps = 20;
        Acceleration<Real> acceleration;
        for (Index iteration = 1;; ++iteration) {
            const bool accelerated = iteration > plain_sweeps && !only_equations;
            const SweepChange change = sweep_once(only_equations, accelerated);
            if (change.squared_change == 0 || (change.squared_change <= small && !stage_.settings.fixed_iterations))
                return 0;
            if (iteration >= stage_.settings.max_iterations) return change.squared_change;
            if (accelerated)
                extrapolate(acceleration.next(change, false));
            else if (iteration == plain_sweeps)
                remember();
        }
    }

    /// Does one sweep. SweepChange::reversal is computed only if the sweeps are `accelerated`.
    SweepChange sweep_once(bool only_equations, bool accelerated) {
        const SweepChange of_joints = others_.sweep_joints(velocity_);
        return region_.traversal.template sum<SweepChange>(region_.row.size(), [&](std::size_t begin, std::size_t end) {
            SweepChange sum = begin == 0 ? of_joints : SweepChange{};
            for (std::size_t i = begin; i < end; ++i) {
                if (only_equations && !region_.memory.contact[i].friction.ties()) continue;
                Real& impulse = memory_.impulse[i];
                const Real before = impulse;
                const Real size = op_.push(static_cast<Index>(i), memory_.bias[i], velocity_.data(), impulse);
                sum.squared_change += size;
                if (accelerated && impulse != before)
                    sum.reversal -= size / (impulse - before) * (impulse - memory_.impulse_before[i]);
            }
            return sum;
        });
    }

    void remember() {
        region_.traversal.nodes(velocity_.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) velocity_before_[n] = velocity_[n];
        });
        region_.traversal.contacts(region_.row.size(), [this](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) memory_.impulse_before[i] = memory_.impulse[i];
        });
        others_.remember();
    }

    /// Extrapolates impulses and pseudo velocities by one factor, which keeps them consistent.
    void extrapolate(Real factor) {
        region_.traversal.nodes(velocity_.size(), [this, factor](std::size_t begin, std::size_t end) {
            extrapolate_range(begin, end, factor, velocity_, velocity_before_);
        });
        region_.traversal.contacts(region_.row.size(), [this, factor](std::size_t begin, std::size_t end) {
            extrapolate_range(begin, end, factor, memory_.impulse, memory_.impulse_before);
        });
        others_.extrapolate(factor);
    }

    const RegionStage& stage_;
    const Region& region_;
    const Op& op_;
    const Others others_;
    const PushMemory memory_;
    const std::span<Vec4> velocity_, velocity_before_;
    const Real slop_;
    Real largest_request_ = 0;  // largest sum of requested pushes so far (Requested::size) [J]
};

/// Finds frictionless pseudo velocities, which move positions only (docs/methods/contact.md 3.4). The solution of the
/// velocity solve must already be in `stage.out`. The result is in region.memory.scratch.
/// - Contacts that penetrate by more than push_slop separate at least at push_speed, by velocity and pseudo velocity
///   together.
/// - At any other contact, the push may close the gap that remains after the velocity solve, but not more.
template <class Region, RegionOperator Op>
[[gnu::always_inline]] inline PushOutcome solve_push(const RegionStage& stage, const Region& region, const Op& op) {
    const Real slop = push_slop(stage.inputs.gravity, stage.h);
    const bool pressed = std::ranges::any_of(region.row, [&](Index i) { return stage.inputs.gap[i] < -slop; });
    auto others = region.pushed(stage, op);
    if (!pressed && !others.any_rotation()) return {};
    return Push(stage, region, op, std::move(others)).run(pressed);
}

}  // namespace skerry
