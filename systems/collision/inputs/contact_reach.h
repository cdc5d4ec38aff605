// How far apart things can be and still matter: the bounds on which the lists of the collision stages rest. They are
// Verlet lists, with a travel in place of a time to live. For a pair P at a present moment,
//
//   D(t)      the distance of two of its features, or of its bodies
//   T(t)      the sum of both partners' travels, each in its frame (BodyTable), and of the way that one frame has made
//             as the other sees it; to a collider the body's travel, the way of its frame and the collider's travel
//   d0        the sum of both partners' displacements when something was noted, at time 0
//   T0 = T(0) - 2 d0                       (pair_travel_base)
//   F = T(t) + closing                     (travel_bound; closing: what both may come nearer within the step that
//   begins)
//
// 1. Motion:      D(t) >= D(0) - (T(t) - T0). (measure_displacement.h; common motion of both is no motion)
// 2. Contact:     a candidate of gap g is a contact of this step only if g <= reach(h, its own relative speed).
// 3. Front:       T(t) + reach <= F for every candidate of the pair: the pair's speeds are at least the candidate's.
// 4. Asleep:      F < T0 + g(0) implies g(t) > reach, by 1 and 3: asleep_until = T0 + g(0), one comparison.
// 5. List:        if all features with D(0) < zone + m are listed, F < T0 + m implies that no other has D(t) < zone or
//                 can be a contact: valid_until = T0 + m.
// 6. Broad phase: if all pairs of bodies a, b are listed whose boxes, grown by margins m_a and m_b and their contact
//                 distances, overlap at time 0, the list holds while F_b < T_b(0) - 2 d_b(0) + m_b for every body b
//                 alone, T_b with the way of its frame: body_valid_until.
//
// F covers the step that begins, so that lists need no further margin for it. Travels are sums of rounded numbers; the
// constant part of reach is larger than their rounding by many orders.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

// Forces of the step can add to the speeds at its start. What is missed by that is met one step later inside the
// contact shell; what they take further find_crossings stops.
inline constexpr Real speed_safety = 2.0;

// Features that approach each other by less than this fraction of their distance in the step cannot meet, by far.
inline constexpr Real slow_fraction = 0.5;

// Fraction of the contact distance that counts as touching already: a resting pile keeps its contacts while it
// trembles.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h, m, at one relative speed or eight.
template <class T>
T reach(Real h, const T& relative_speed, Real gravity, Real contact_distance) {
    return speed_safety * h * (relative_speed + 2 * gravity * h) + touching_fraction * contact_distance;
}

/// The distances of one pair, m.
struct PairScale {
    Real contact_distance;  // kept free between the features: that of the surfaces, and the radii of round bodies
    Real shell;             // of it, what is kept free between the surfaces
    Real edge;              // the smaller of the mean surface edges
    Real face_depth;        // a point this deep behind a face is pushed out of it
    Real edge_depth;        // the same behind an edge or vertex, and for two edges
    Real zone;  // features nearer than this, on either side, are looked at in each step; of a collider see face_zone
    Real radii = 0;  // of contact_distance, those of round bodies, whose cores are the features
};

// Overlap is rare, the contact distance keeps surfaces apart. Deeper points may belong to the other side of a thin
// body.
inline constexpr Real face_depth_fraction = 0.25;  // of the edge
inline constexpr Real edge_depth_fraction = 0.02;  // of the edge, or the contact distance

/// A point of a collider that is nearer to a face than this, on either side, is looked at in each step, m.
inline Real face_zone(const PairScale& scale) {
    return std::max(scale.contact_distance, scale.face_depth);
}

/// How near the cores of round bodies may come in the motion of a step. Contacts stop them at the shell, which is not
/// near; without one they touch by rounding, and only their cores are looked at.
inline KeptApart kept_of_radii(const PairScale& scale) {
    return scale.radii > 0 && scale.shell > 0 ? KeptApart{scale.radii, contact_slack * scale.shell} : KeptApart{};
}

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Whether nothing of a pair can have come through the other: contacts hold it from both sides, and find_crossings sees
/// to it. Without a shell touching surfaces may overlap by rounding.
inline bool is_held_apart(const CollisionSettings& settings, PairState state, const PairScale& scale) {
    return settings.continuous && state == PairState::apart && scale.contact_distance > 0;
}

/// What is held apart is a contact at the contact distance from either side, so that no depth behind a surface needs a
/// zone.
inline PairScale pair_scale_as_known(const CollisionSettings& settings, PairState state, PairScale scale) {
    if (is_held_apart(settings, state, scale)) scale.zone = scale.edge_depth;
    return scale;
}

/// Friction and restitution of a pair: geometric mean and maximum. A collider without surface properties takes the
/// body's.
SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Sum of what both partners have moved in their frames since their origins were set, m.
inline Real pair_displacement(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    return inputs.body.displacement[first] + (kind == PairKind::collider ? 0 : inputs.body.displacement[second]);
}

/// T0, m: what is noted now of a distance holds while travel_bound is below T0 plus that distance.
inline Real pair_travel_base(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return pairs.travel[p] - 2 * pair_displacement(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]);
}

}  // namespace skerry
