// How sweeps are accelerated (docs/methods/region_solver.md 2): Nesterov's extrapolation, with a restart when the step
// turns against the motion, a guard on the residual, and a watchdog that goes back to plain sweeps when nothing is
// gained. One policy for all regions: T is Real, or Real8 for eight regions side by side, each lane on its own with the
// bits of one alone. The numbers were tuned by hand on the sheets, stacks and tilted jams of docs/solvers.md,
// "Constants".
#pragma once

#include <algorithm>
#include <limits>

#include "systems/material/lane_math.h"
#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// What a comparison of T gives.
template <class T>
using LaneMask = decltype(T{} < T{});

/// The momentum of Nesterov's sequence (Nesterov 1983), restarted as in O'Donoghue and Candes 2015.
template <class T>
class Acceleration {
public:
    /// By how much to extrapolate after a sweep; 0 where the momentum starts anew. `plain`: where it has to.
    T next(const SweepChangeOf<T>& change, const LaneMask<T>& plain) {
        // of a sweep's squared change to the smallest since the restart: 10 is 15 % faster on easy problems and fails
        // on jammed ones
        constexpr Real guard = 2;
        const T zero{}, one = zero + 1;
        const T next_momentum = (1 + square_root(T(1 + 4 * momentum_ * momentum_))) / 2;
        smallest_change_ = change.size < smallest_change_ ? change.size : smallest_change_;
        const LaneMask<T> restart = plain | (change.against > zero) | (change.size > guard * smallest_change_);
        const T extrapolation = restart ? zero : (momentum_ - 1) / next_momentum;
        momentum_ = restart ? one : next_momentum;
        smallest_change_ = restart ? change.size : smallest_change_;
        return extrapolation;
    }

private:
    T momentum_ = T{} + 1, smallest_change_ = T{} + std::numeric_limits<Real>::infinity();
};

/// Sweeps without gain that the watchdog waits for at least; after a while half of the sweeps since it last barked.
inline constexpr Index watchdog_patience = 60;

/// When to trust the acceleration. Lanes are swept for no longer than its patience: theirs sleeps.
template <class T>
class Watchdog {
public:
    Real relaxation() const { return 1; }
    LaneMask<T> plain_after(Index, const T&) { return LaneMask<T>{}; }
};

template <>
class Watchdog<Real> {
public:
    /// With which relaxation the next sweep is done.
    Real relaxation() const { return relaxation_; }

    /// Whether the sweep that was done, or the next one, is a plain one. `change`: that of the sweep, squared.
    bool plain_after(Index iteration, Real change) {
        const bool was_plain = plain_left_ > 0;
        observe(iteration, change);
        return was_plain || plain_left_ > 0;
    }

private:
    static constexpr Real gain = 0.7;           // of squared change to the best: less is progress
    static constexpr Index plain_sweeps = 200;  // doubled with each phase, the first one included
    static constexpr Index most_doublings = 7, most_plain = 20000;
    static constexpr Real damped = 0.8;  // relaxation of every second phase: for what plain sweeps cycle on

    void observe(Index iteration, Real change) {
        if (change < gain * best_) {
            best_ = change;
            best_at_ = iteration;
        }
        if (plain_left_ > 0) {
            if (--plain_left_ > 0) return;
            relaxation_ = 1;
            best_ = change;
            best_at_ = iteration;
        } else if (iteration - best_at_ > std::max<Index>(watchdog_patience, (iteration - last_phase_) / 2)) {
            ++phase_;
            last_phase_ = best_at_ = iteration;
            plain_left_ = std::min(plain_sweeps << std::min(phase_, most_doublings), most_plain);
            relaxation_ = phase_ % 2 == 0 ? damped : 1;
            best_ = std::numeric_limits<Real>::infinity();
        }
    }

    Real best_ = std::numeric_limits<Real>::infinity();
    Index best_at_ = 0, last_phase_ = 0, phase_ = 0, plain_left_ = 0;
    Real relaxation_ = 1;
};

}  // namespace skerry
