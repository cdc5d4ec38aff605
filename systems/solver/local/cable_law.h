// Law of a cable that runs through points of bodies: prescribed length or tension, and friction at the points
// (docs/methods/cables.md 2). Also the law of a tie that holds the mean of many points (docs/methods/ties.md).
#pragma once

#include <span>

#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Law of a cable with n segments (docs/methods/cables.md 2). The tension of segment s has the impulse r_s >= 0 [N s].
/// Impulses change the rates of length u of the segments [m/s] by -A r, with the mobility matrix A.
///
/// At the point between the segments s - 1 and s, friction bounds the ratio of the tensions. With e = exp(mu times the
/// angle of wrap): r_(s-1) / e <= r_s <= r_(s-1) e.
struct CableLaw {
    Index first = 0;   // index of the first point among the contact rows of the region
    Index moving = 0;  // index of the first point that impulses can move, counted like `first`
    Index points = 0;  // number of points
    // True for a tie, whose impulse r makes the sum u of the velocities of its points zero. `impulse` then has the
    // three components of r, which acts on each point, and `rate` those of u, which changes by +A r. `direction`,
    // `most_ratio` and `far_mobility` are unused.
    bool is_tie = false;
    bool by_length = false;
    Real prescribed = 0;  // if `by_length`: upper bound of the sum of the u_s [m/s]; else: impulse r_0 [N s]
    std::span<const Vec3> direction;   // by segment: unit vector to the next point; 0 if the segment has no length
    std::span<const Real> most_ratio;  // by segment: limit e of the ratio of tensions at the start of the segment
    std::span<const Real> mobility;    // A, row by row [1/kg]
    // For each segment s: sum of A_ij over i, j >= s [1/kg]. The rate of length of the cable from segment s on falls by
    // this sum if the impulses of all these segments grow by 1 N s.
    std::span<Real> far_mobility;
    // Columns by segment: impulses [N s] and rates of length [m/s] at present, and scratch of
    // BodyOperator::sweep_cables.
    // - `before`: impulses before the cable is solved, later their change by the solve
    // - `previous`: impulses of the previous sweep, later the change since that sweep
    std::span<Real> impulse, rate, before, previous;
    static constexpr std::size_t numbers_by_segment = 5;  // number of the spans by segment, from far_mobility on

    std::size_t segments() const { return impulse.size(); }
    /// Computes the impulse r_s of each segment s from the impulses on the points of the cable, with which `point`
    /// begins. Segment s acts on its first point with the impulse r_s `direction`, and on its last point with the
    /// opposite impulse.
    ///
    /// A segment without length has the impulse of the segment before it, or of the first segment with a length.
    void read(std::span<const Vec4> point, std::span<Real> impulse_of_segment) const;
    /// Impulse at point `p` due to `impulses` of the segments or of the tie [N s].
    Vec3 at_point(std::span<const Real> impulses, std::size_t p) const;
    /// Fills far_mobility.
    void prepare() const;
    /// Solves the law, starting from the present `impulse`. The impulses of contacts and of other cables stay. Updates
    /// `impulse` and `rate`.
    void solve() const;
    /// Squared residual of the law at the present impulses and rates, in the energy norm [J] (docs/methods/errors.md
    /// 1).
    Real squared_residual() const;
    /// Energy product a . A b of the impulses a and b [J].
    Real product(std::span<const Real> a, std::span<const Real> b) const;

private:
    Real entry(std::size_t row, std::size_t column) const { return mobility[row * segments() + column]; }
    /// Rate of length of the cable from segment `s` on [m/s].
    Real far_rate(std::size_t s) const;
    /// New impulse of segment `s` by the law [N s]. `rate_mobility`: decrease of far_rate(s) per unit of this impulse
    /// [1/kg].
    /// - First segment: the law prescribes the tension or bounds the length.
    /// - Any other segment: the law demands far_rate(s) = 0 within the limits of friction.
    Real next_impulse(std::size_t s, Real rate_mobility) const;
    Real step(std::size_t s) const;
    /// Change of the impulse of a tie that makes its rate zero [N s].
    Vec3 change_of_tie() const;
};

}  // namespace skerry
