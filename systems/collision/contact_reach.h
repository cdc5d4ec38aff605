// How far apart things can be and still matter. All budgets of the collision stages rest on this page.
//
// 1. A candidate becomes a contact of this step when gap <= reach(h, its own relative speed, ...): it could close within the step.
// 2. No node of a body has come further since some time than the growth of `travel` since then plus twice the `drift` at that time
//    (measure_drift.h). So a distance d of a pair is at least d - (T - T0) later, where T is the sum of both travels later and T0 that sum
//    now less twice both drifts (pair_datum). `front` = T + what the two may close in this step, by their greatest speeds; it bounds
//    T + reach of every candidate of the pair from above.
// 3. A candidate with gap g at T0 cannot be a contact while front < T0 + g. That is asleep_until: one comparison.
// 4. A candidate list that holds everything nearer than zone + m at T0 (zone: the distance at which a candidate matters, whatever the
//    speeds) is complete while front < T0 + m. That is valid_until of the pair.
// 5. A list of pairs that holds all boxes nearer than the sum of their margins m_b (and contact distances) is complete while the front of
//    every single body is below T_b + m_b. That is body_valid_until.
// The step that begins is always inside `front`, so the lists need no further margin for it. Sums of travels are rounded; the constant part
// of reach is larger by many orders.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/collision_inputs.h"

namespace skerry {

// Forces of the step can add to the speeds at its start. What is missed by that is met one step later, still inside the contact shell.
inline constexpr Real speed_safety = 2.0;

// Fraction of the contact distance that counts as touching already: a resting pile keeps its contacts while it trembles.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h, m.
inline Real reach(Real h, Real relative_speed, Real gravity, Real contact_distance) {
    return speed_safety * h * (relative_speed + 2 * gravity * h) + touching_fraction * contact_distance;
}

/// The distances of one pair, m.
struct PairScale {
    Real contact_distance;  // kept free between the surfaces
    Real edge;              // the smaller of the mean surface edges
    Real face_depth;        // a point this deep behind a face is pushed out of it
    Real edge_depth;        // the same behind an edge or vertex, and for two edges
    Real zone;              // features nearer than this, on either side, are looked at in each step
};

// Overlap is rare, the contact distance keeps surfaces apart. Deeper points may belong to the other side of a thin body.
inline constexpr Real face_depth_fraction = 0.25;  // of the edge
inline constexpr Real edge_depth_fraction = 0.02;  // of the edge, or the contact distance

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Friction and restitution of a pair: geometric mean and maximum. A collider without surface properties takes the body's.
SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Sum of the travels of both partners, m.
inline Real pair_travel(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const Real own = inputs.body.travel[first];
    return own + (kind == PairKind::collider ? inputs.collider.travel[second] : inputs.body.travel[second]);
}

/// T0 of the page above, m: what is noted now holds while front is below it plus a distance.
inline Real pair_datum(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const Real drift = inputs.body.drift[first] + (kind == PairKind::collider ? 0 : inputs.body.drift[second]);
    return pair_travel(inputs, kind, first, second) - 2 * drift;
}

}  // namespace skerry
