// Bounds on travel that decide how long the lists of the collision stages are valid. The lists are Verlet lists, but
// they expire after a certain travel instead of a certain time. The bounds use these quantities of a pair:
//
//   D(t)      distance at time t between two features of the pair, or between its bodies
//   g(t)      gap of a candidate, which is D(t) minus the contact distance
//   T(t)      travel of the pair. For two bodies it is the sum of the travels of both bodies in their frames (see
//             BodyTable) and of the path of one frame relative to the other. For a body and a collider it is the sum of
//             the travel of the body, the path of the body's frame and the travel of the collider.
//   d0        sum of BodyTable::displacement of both partners at time 0, when D(0) was measured; 0 for a collider
//   T0        T0 = T(0) - 2 d0 (pair_travel_base), so T - T0 is the travel since time 0 plus 2 d0. Reason for 2 d0:
//             the travel of a body sums the changes of its displacement d, the greatest distance of a node from its
//             origin. A node can move by 2 d to the opposite side of its origin while d, and so the travel, does not
//             change.
//   F         front, F = T(t) plus an upper bound of the decrease of D in this step (PairTable::travel_bound)
//   zone, m   zone: distance below which features are tested in each step (PairScale); m: margin of a list
//
// 1. Motion:      D(t) >= D(0) - (T(t) - T0). Common motion of both partners does not count (measure_displacement.h).
// 2. Contact:     a candidate becomes a contact of this step only if g <= reach(h, relative speed of the candidate).
// 3. Front:       T(t) + reach <= F for every candidate, because no candidate is faster than its pair.
// 4. Asleep:      F < T0 + g(0) implies g(t) > reach, by 1 and 3. So a candidate sleeps (needs no test) until F reaches
//                 asleep_until = T0 + g(0).
// 5. List:        suppose that all features with D(0) < zone + m are listed. Then F < T0 + m implies that no other
//                 features have D(t) < zone or become a contact. So the list is valid until F reaches
//                 valid_until = T0 + m.
// 6. Broad phase: suppose that all pairs of bodies a, b are listed whose boxes overlap at time 0 when they are grown by
//                 margins m_a and m_b and by the contact distances. The list is complete while the front of every
//                 single body b satisfies F_b < T_b(0) - 2 d_b(0) + m_b = body_valid_until. The travel T_b of the body
//                 and d_b are defined like T and d0; T_b includes the path of the body's frame.
//
// F includes the step that begins, so that the lists need no further margin for this step. Rounding errors of the
// travels, which are sums, need no margin either: the constant part of reach is larger by many orders of magnitude.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

// Safety factor on speeds, because forces can increase the speeds during the step. If the increase exceeds the factor,
// the contact is found one step later, when the distance may already be below the contact distance. Motions that would
// make surfaces cross are detected by find_crossings.
inline constexpr Real speed_safety = 2.0;

// Features are not tested for a crossing in the step if the upper bound of their approach is at most this fraction of
// their distance. The fraction 1 would suffice without rounding errors.
inline constexpr Real slow_fraction = 0.5;

// Two features with a gap below this fraction of the contact distance get a contact even if they do not approach each
// other. The contacts of a resting pile therefore persist while the pile vibrates.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h [m]. The term 2 gravity h bounds the change of the relative
/// speed, because gravity can change the speed of each partner by gravity h. T is Real, or a vector type for several
/// relative speeds at once.
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

/// Distances for the crossing test of round bodies, whose features are the cores (centres or axes). Throughout the
/// step, the distance between the cores must remain above the sum of the radii. The bodies count as in contact if the
/// gap between their surfaces is below contact_slack times the shell distance (PairScale::shell). With zero shell
/// distance, surfaces in contact may overlap by rounding errors. The distance that must remain is then zero, so only
/// crossings of the cores are found.
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
