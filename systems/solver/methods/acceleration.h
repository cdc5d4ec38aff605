// Acceleration of sweeps (docs/methods/region_solver.md 2): Nesterov's extrapolation, a restart when a step turns
// against the motion, a bound on the residual, and a watchdog that returns to plain sweeps if nothing is gained. T is
// Real, or Real8 for eight regions in SIMD lanes; each lane has the bits of a region solved alone. The constants were
// tuned by hand on the sheets, stacks and tilted jams of docs/solvers.md, "Constants".
#pragma once

#include <algorithm>
#include <limits>

#include "systems/material/lane_math.h"
#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// Result type of a comparison of T.
template <class T>
using LaneMask = decltype(T{} < T{});

/// Momentum of Nesterov's sequence (Nesterov 1983), restarted as in O'Donoghue and Candes 2015.
template <class T>
class Acceleration {
public:
    /// Extrapolation factor after a sweep; 0 at a restart. `plain` forces a restart.
    T next(const SweepChangeOf<T>& change, const LaneMask<T>& plain) {
        // Bound on a sweep's squared change, relative to the smallest one since the restart. 10 is 15 % faster on easy
        // problems and fails on jammed ones.
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

/// Fewest sweeps without gain before the watchdog acts. Later it waits for half of the sweeps since it last acted.
inline constexpr Index watchdog_patience = 60;

/// Decides when to use the acceleration. The lane version never acts: lanes do fewer sweeps than its patience.
template <class T>
class Watchdog {
public:
    Real relaxation() const { return 1; }
    LaneMask<T> plain_after(Index, const T&) { return LaneMask<T>{}; }
};

template <>
class Watchdog<Real> {
public:
    /// Relaxation of the next sweep.
    Real relaxation() const { return relaxation_; }

    /// True if the last or the next sweep is a plain one. `change`: squared change of the last sweep.
    bool plain_after(Index iteration, Real change) {
        const bool was_plain = plain_left_ > 0;
        observe(iteration, change);
        return was_plain || plain_left_ > 0;
    }

private:
    static constexpr Real gain = 0.7;           // progress: squared change below this fraction of the best
    static constexpr Index plain_sweeps = 200;  // doubled with each phase, including the first
    static constexpr Index most_doublings = 7, most_plain = 20000;
    static constexpr Real damped = 0.8;  // relaxation of every second phase, for problems on which plain sweeps cycle

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
