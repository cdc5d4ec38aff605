// Split impulse (push-out) of a region: separates penetrating contacts without adding energy, by pseudo velocities that
// move nodes in this step only (docs/methods/contact.md 3.4).
#pragma once

#include <algorithm>
#include <concepts>
#include <span>
#include <utility>

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
    /// Does one sweep over the joints. Returns the squared energy norm of the impulse change [J]
    Real sweep_joints(std::span<Vec4>) const { return 0; }
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
          slop_(push_slop(stage.inputs.gravity, stage.h)) {}

    /// Computes the pseudo velocities. Returns false if all are zero. `pressed`: true if some contact penetrates by
    /// more than the slop, the depth up to which penetrations are not corrected.
    bool run(bool pressed) {
        clear();
        const Requested requested = request();
        if (!pressed && !requested.by_rotation) return false;
        sweep(requested.size);
        // The push rotates bodies, and rotation changes the gaps of contacts. So the loss of gap is computed again with
        // the new rotation, and more sweeps compensate for it. This is done `rotation_rounds` times.
        constexpr int rotation_rounds = 2;
        for (int round = 0; round < rotation_rounds && others_.any_rotation(); ++round) sweep(request().size);
        return true;
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

    void sweep(Real requested) {
        if (sweep_rows(region_.tolerance * region_.tolerance * requested, false)) return;
        // Joints and ties can prevent contacts from being pushed apart, so that the sweeps do not converge. The last
        // sweeps then visit only joints and ties: if their positions kept an error, the next velocity solve would
        // demand a motion that the contacts forbid.
        constexpr Real rounding = 1e-24;  // square of the relative tolerance 1e-12
        sweep_rows(rounding * requested, true);
    }

    /// Sweeps over the joints and contacts, or over the joints and ties only, until the squared energy norm of the
    /// change of a sweep is at most `small`. Returns true if this happens within max_iterations.
    bool sweep_rows(Real small, bool only_equations) {
        for (Index iteration = 1; iteration <= stage_.settings.max_iterations; ++iteration) {
            const Real joint_change = others_.sweep_joints(velocity_);
            const Real change =
                region_.traversal.template sum<Real>(region_.row.size(), [&](std::size_t begin, std::size_t end) {
                    Real size = begin == 0 ? joint_change : 0;
                    for (std::size_t i = begin; i < end; ++i)
                        if (!only_equations || region_.memory.contact[i].friction.ties())
                            size +=
                                op_.push(static_cast<Index>(i), memory_.bias[i], velocity_.data(), memory_.impulse[i]);
                    return size;
                });
            if (change == 0 || (change <= small && !stage_.settings.fixed_iterations)) return true;
        }
        return false;
    }

    const RegionStage& stage_;
    const Region& region_;
    const Op& op_;
    const Others others_;
    const PushMemory memory_;
    const std::span<Vec4> velocity_;
    const Real slop_;
};

/// Pushes penetrating bodies apart by a split impulse without friction (docs/methods/contact.md 3.4): finds pseudo
/// velocities, which move positions only. The solution of the velocity solve must already be in `stage.out`. The result
/// is in region.memory.scratch. Returns false if no contact is pushed.
///
/// Each contact has a normal velocity u_n, given by the velocity solve, and a normal pseudo velocity p_n:
/// - If the bodies penetrate by more than push_slop(), u_n + p_n must be at least push_speed().
/// - Otherwise p_n may be negative and close the gap that is left after the motion with u_n, but not more.
template <class Region, RegionOperator Op>
[[gnu::always_inline]] inline bool solve_push(const RegionStage& stage, const Region& region, const Op& op) {
    const Real slop = push_slop(stage.inputs.gravity, stage.h);
    const bool pressed = std::ranges::any_of(region.row, [&](Index i) { return stage.inputs.gap[i] < -slop; });
    auto others = region.pushed(stage, op);
    if (!pressed && !others.any_rotation()) return false;
    return Push(stage, region, op, std::move(others)).run(pressed);
}

}  // namespace skerry
