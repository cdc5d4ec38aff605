// Acceleration of sweeps by Nesterov's extrapolation (docs/methods/region_solver.md 2). It is restarted when a sweep
// moves the impulses against the previous direction, or by much more than earlier sweeps. A watchdog returns to plain
// sweeps if there is no progress.
//
// T is Real, or Real8 for eight regions in SIMD lanes. Each lane has the bits of a region solved alone.
//
// The constants were tuned by hand on generated problems: sheets, stacks, and jams (sheets with normals tilted by up to
// 70 degrees).
#pragma once

#include <algorithm>

#include "systems/material/lane_math.h"
#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// Result type of a comparison of two values of type T.
template <class T>
using LaneMask = decltype(T{} < T{});

/// Extrapolation factors of Nesterov's method (Nesterov 1983), with restarts as in O'Donoghue and Candes 2015.
template <class T>
class Acceleration {
public:
    /// Returns the extrapolation factor after a sweep with this change of the impulses; 0 at a restart. `plain` forces
    /// a restart.
    T next(const SweepChangeOf<T>& change, const LaneMask<T>& plain) {
        // A restart occurs if the squared impulse change of a sweep exceeds this multiple of the smallest squared
        // change since the last restart. The value 10 would be 15 % faster on easy problems, but fails on jammed ones.
        constexpr Real guard = 2;
        const T zero{}, one = zero + 1;
        const T next_momentum = (1 + square_root(T(1 + 4 * momentum_ * momentum_))) / 2;
        smallest_change_ = change.squared_change < smallest_change_ ? change.squared_change : smallest_change_;
        const LaneMask<T> restart =
            plain | (change.reversal > zero) | (change.squared_change > guard * smallest_change_);
        const T extrapolation = restart ? zero : (momentum_ - 1) / next_momentum;
        momentum_ = restart ? one : next_momentum;
        smallest_change_ = restart ? change.squared_change : smallest_change_;
        return extrapolation;
    }

private:
    T momentum_ = T{} + 1, smallest_change_ = T{} + infinity;
};

/// Number of sweeps in a row without progress after which the watchdog switches to plain (not accelerated) sweeps. In a
/// long solve the number is half of the sweeps since the start or the last switch, if this is more.
inline constexpr Index watchdog_patience = 60;

/// Decides whether sweeps are accelerated. The version for lanes never intervenes, because lanes do at most
/// watchdog_patience sweeps.
template <class T>
class Watchdog {
public:
    Real relaxation() const { return 1; }
    LaneMask<T> plain_after(Index, const T&) { return LaneMask<T>{}; }
};

template <>
class Watchdog<Real> {
public:
    /// Relaxation factor of the next sweep.
    Real relaxation() const { return relaxation_; }

    /// True if the last or the next sweep is plain (not accelerated). `change` is the squared impulse change of the
    /// last sweep.
    bool plain_after(Index iteration, Real change) {
        const bool was_plain = plain_left_ > 0;
        observe(iteration, change);
        return was_plain || plain_left_ > 0;
    }

private:
    // A squared impulse change below this fraction of `best_` counts as progress.
    static constexpr Real gain = 0.7;
    // A phase is a sequence of plain sweeps. Phase k = 1, 2, ... has plain_sweeps times 2^k sweeps, or 2^most_doublings
    // if k is greater, but never more than most_plain sweeps.
    static constexpr Index plain_sweeps = 200;
    static constexpr Index most_doublings = 7, most_plain = 20000;
    // Relaxation factor in every second phase, for problems on which undamped plain sweeps cycle.
    static constexpr Real damped = 0.8;

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
            best_ = infinity;
        }
    }

    Real best_ = infinity;
    Index best_at_ = 0, last_phase_ = 0, phase_ = 0, plain_left_ = 0;
    Real relaxation_ = 1;
};

}  // namespace skerry
