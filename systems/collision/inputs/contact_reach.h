// Bounds on travel that decide how long the lists of the collision stages are valid (docs/methods/collision.md 2). The
// lists are Verlet lists, but they expire after a certain travel instead of a certain time. Travel is a counter that
// bounds how far the nodes of a body move in its frame (BodyTable). The bounds use these quantities of a pair:
//
//   D(t)      distance at time t between two features of the pair, or between its bodies
//   g(t)      gap of a candidate: D(t) minus the contact distance
//   T(t)      travel of the pair: the bound PairTable::travel on the relative motion of its partners
//   d0        sum of BodyTable::displacement of both partners at time 0, when D(0) was measured; 0 for a collider
//   T0        T(0) - 2 d0 (pair_travel_base). Reason for 2 d0: a node can move by 2 d, to the opposite side of its
//             origin, while the displacement d of its body, and so the travel, does not change.
//   F         front: T(t) plus an upper bound of the decrease of D in this step (PairTable::travel_bound)
//   zone      distance below which features are tested in each step (PairScale)
//   m         margin of a list
//
// 1. Motion:      D(t) >= D(0) - (T(t) - T0). Common motion of both partners does not count (measure_displacement.h).
// 2. Contact:     a candidate becomes a contact of this step only if g <= reach(h, relative speed of the candidate).
// 3. Front:       T(t) + reach <= F for every candidate, because no candidate is faster than its pair.
// 4. Asleep:      F < T0 + g(0) implies g(t) > reach, by 1 and 3. So a candidate sleeps (needs no test) until F reaches
//                 asleep_until = T0 + g(0).
// 5. List:        if all features with D(0) < zone + m are listed, the list is valid until F reaches
//                 valid_until = T0 + m: until then, no other features have D(t) < zone or become a contact.
// 6. Broad phase: suppose that all pairs of bodies are listed whose boxes overlap at time 0, when each is grown by the
//                 margin m_b of its body b and by the contact distance. The list is complete while the front F_b of
//                 every body b is below body_valid_until = T_b(0) - 2 d_b(0) + m_b. d_b is the displacement of the
//                 body, and T_b its travel plus the path of its frame.
//
// F includes the step that begins, so the lists need no further margin for this step. Nor do they need one for rounding
// errors of the travels, which are sums: the constant part of reach is larger by many orders of magnitude.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

// Safety factor on speeds, because forces can increase the speeds during the step. If they increase by more, the
// contact is found one step later, perhaps below the contact distance; find_crossings prevents that surfaces cross
// meanwhile.
inline constexpr Real speed_safety = 2.0;

// Features are not tested for a crossing in the step if the upper bound of their approach is at most this fraction of
// their distance. The fraction 1 would suffice without rounding errors.
inline constexpr Real slow_fraction = 0.5;

// Two features with a gap below this fraction of the contact distance get a contact even if they do not approach each
// other. The contacts of a resting pile therefore persist while the pile vibrates.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h [m]. Gravity can change the speed of each partner by gravity h,
/// and thus the relative speed by 2 gravity h. T is Real, or a vector type for several relative speeds at once.
template <class T>
T reach(Real h, const T& relative_speed, Real gravity, Real contact_distance) {
    return speed_safety * h * (relative_speed + 2 * gravity * h) + touching_fraction * contact_distance;
}

/// Characteristic distances of one pair [m].
struct PairScale {
    Real contact_distance;  // distance that contacts maintain between the features: shell + radii
    Real shell;             // distance that contacts maintain between the surfaces
    Real edge;              // smaller mean edge length of the two surfaces
    Real face_depth;        // largest depth behind a face at which a point is still pushed out
    // Largest depth behind an edge or vertex at which a point is still pushed out. Also: largest distance of two edges
    // that have passed each other and are still pushed back.
    Real edge_depth;
    // Features are tested in each step while their distance, in front of or behind a surface, is below this value. For
    // points of a collider see face_zone.
    Real zone;
    // Sum of the radii of the round bodies in the pair; the features of a round body are its core (centre or axis).
    Real radii = 0;
};

// Largest depths at which points are pushed out, as fractions of the mean edge length. Deep overlap is rare, because
// the contact distance separates surfaces. A point at a larger depth may have entered a thin body from its other side.
inline constexpr Real face_depth_fraction = 0.25;  // largest depth behind a face
// largest depth behind an edge or vertex, unless the contact distance is larger
inline constexpr Real edge_depth_fraction = 0.02;

/// Distance between a point of a collider and a face below which the two are tested in each step, in front of or behind
/// the face [m].
inline Real face_zone(const PairScale& scale) {
    return std::max(scale.contact_distance, scale.face_depth);
}

/// Distances for the crossing test of round bodies, whose features are the cores (centres or axes). The cores must stay
/// further apart than the sum of the radii. Bodies count as in contact if the gap between their surfaces is below
/// contact_slack times the shell distance (PairScale::shell).
///
/// With zero shell distance, surfaces in contact may overlap by rounding errors, so only crossings of the cores are
/// found.
inline ContactThreshold threshold_of_radii(const PairScale& scale) {
    return scale.radii > 0 && scale.shell > 0 ? ContactThreshold{scale.radii, contact_slack * scale.shell}
                                              : ContactThreshold{};
}

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// True if the surfaces of a pair cannot have passed through each other: they were apart at the last search, and
/// find_crossings has prevented crossings since then. With zero contact distance the result is false, because touching
/// surfaces may overlap by rounding errors.
inline bool is_held_apart(const CollisionSettings& settings, PairState state, const PairScale& scale) {
    return settings.continuous && state == PairState::apart && scale.contact_distance > 0;
}

/// Characteristic distances of a pair whose state is known. If the surfaces cannot have passed through each other, no
/// point has to be pushed out from behind a face, so `zone` need not contain face_depth and is reduced to edge_depth.
inline PairScale pair_scale_as_known(const CollisionSettings& settings, PairState state, PairScale scale) {
    if (is_held_apart(settings, state, scale)) scale.zone = scale.edge_depth;
    return scale;
}

/// Returns the properties in `given`, with each negative one replaced by that of `properties`.
SurfaceProperties with_given(SurfaceProperties properties, const SurfaceProperties& given);

/// Surface of one partner of a contact. `material`: row of MaterialTable, or no_index for a collider without a
/// material. `surface`: its properties; those that a collider does not specify are negative.
struct PartnerSurface {
    Index material;
    SurfaceProperties surface;
};
/// Surface of a body, or of a collider if `collider` is not no_index. A kinematic body has the surface of its collider.
PartnerSurface partner_surface(const CollisionInputs& inputs, Index body, Index collider);

/// Properties of contacts between two surfaces. The friction coefficients are geometric means of the values of both
/// partners; the restitution is the larger value. A negative value of `partner` is replaced by that of `own`.
SurfaceProperties mean_surface(const SurfaceProperties& own, const SurfaceProperties& partner);

/// Friction coefficients and restitution of a pair: those of the pair of materials if they are set, otherwise those of
/// mean_surface.
SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Sum of BodyTable::displacement of the two partners; a collider has none [m].
inline Real pair_displacement(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    return inputs.body.displacement[first] + (kind == PairKind::collider ? 0 : inputs.body.displacement[second]);
}

/// The travel T0 defined at the top of this file [m]: if the distance d between two features of the pair is measured
/// now, the features cannot meet as long as PairTable::travel_bound is below T0 + d.
inline Real pair_travel_base(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return pairs.travel[p] - 2 * pair_displacement(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]);
}

}  // namespace skerry
