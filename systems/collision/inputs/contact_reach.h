// Bounds of travel that decide how long the lists of the collision stages are valid. The lists are Verlet lists, except
// that they expire after a travel and not after a time. The bounds use these quantities of a pair:
//
//   D(t)      distance at time t between two features of the pair, or between its bodies
//   g(t)      gap of a candidate, which is D(t) minus the contact distance
//   T(t)      travel of the pair. For two bodies it is the sum of the travels of both bodies in their frames (see
//             BodyTable) and of the path of one frame relative to the other. For a body and a collider it is the sum of
//             the travel of the body, the path of its frame and the travel of the collider.
//   d0        sum of the displacements of both partners at time 0, when a bound was computed
//   T0        travel from which a bound is counted, T0 = T(0) - 2 d0 (pair_travel_base)
//   F         front, F = T(t) + closing (travel_bound), where `closing` bounds the decrease of D(t) in this step
//   zone, m   distance below which features are tested in each step (PairScale), and margin of a list
//
// 1. Motion:      D(t) >= D(0) - (T(t) - T0). Motion that both partners share does not count (measure_displacement.h).
// 2. Contact:     a candidate becomes a contact of this step only if g <= reach(h, relative speed of the candidate).
// 3. Front:       T(t) + reach <= F for every candidate, because no candidate is faster than its pair.
// 4. Asleep:      F < T0 + g(0) implies g(t) > reach, by 1 and 3. So a candidate sleeps until asleep_until = T0 + g(0).
// 5. List:        suppose that all features with D(0) < zone + m are listed. Then F < T0 + m implies that no other
//                 features have D(t) < zone or become a contact. So the list is valid until valid_until = T0 + m.
// 6. Broad phase: suppose that all pairs of bodies a, b are listed whose boxes overlap at time 0 when they are grown by
//                 margins m_a and m_b and by the contact distances. The list is complete while the front of every
//                 single body b satisfies F_b < T_b(0) - 2 d_b(0) + m_b = body_valid_until. The travel T_b of the body
//                 and d_b are defined like T and d0; T_b includes the path of the body's frame.
//
// F includes the step that begins, so that the lists need no further margin for this step. Travels are sums of rounded
// numbers. The constant part of reach exceeds their rounding errors by many orders of magnitude.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

// Safety factor of speeds, because forces can add to the speeds at the start of the step. A contact that is still
// missed is found one step later, when it is nearer than the contact distance. find_crossings stops larger motions.
inline constexpr Real speed_safety = 2.0;

// Features cannot meet in the step if their approach is below this fraction of their distance. This includes a wide
// margin.
inline constexpr Real slow_fraction = 0.5;

// Fraction of the contact distance below which a gap counts as closed. So a resting pile keeps its contacts while it
// vibrates.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h [m], for one relative speed or for eight speeds at once.
template <class T>
T reach(Real h, const T& relative_speed, Real gravity, Real contact_distance) {
    return speed_safety * h * (relative_speed + 2 * gravity * h) + touching_fraction * contact_distance;
}

/// Characteristic distances of one pair [m].
struct PairScale {
    Real contact_distance;  // distance kept between the features: shell + radii
    Real shell;             // distance kept between the surfaces
    Real edge;              // smaller one of the mean edge lengths of both surfaces
    Real face_depth;        // largest depth behind a face from which a point is pushed out
    Real edge_depth;        // the same limit behind an edge or vertex, and for two edges
    // Features nearer than this, in front of or behind each other, are tested in each step. For points of a collider
    // see face_zone.
    Real zone;
    Real radii = 0;  // sum of the radii of round bodies, whose features are their cores
};

// Depth limits as fractions of the mean edge length. Deep overlap is rare, because the contact distance keeps surfaces
// apart. A deeper point may belong to the other side of a thin body.
inline constexpr Real face_depth_fraction = 0.25;  // depth limit behind a face
// Depth limit behind an edge or vertex, but at least the contact distance.
inline constexpr Real edge_depth_fraction = 0.02;

/// A point of a collider is tested in each step if it is nearer to a face than this, in front of or behind it [m].
inline Real face_zone(const PairScale& scale) {
    return std::max(scale.contact_distance, scale.face_depth);
}

/// Distance that the cores of round bodies have to keep during the motion of a step. Contacts stop round bodies at the
/// shell distance between their surfaces, which does not count as near contact. If the shell distance is zero, surfaces
/// touch up to rounding, and only the cores are tested for crossings.
inline KeptApart kept_of_radii(const PairScale& scale) {
    return scale.radii > 0 && scale.shell > 0 ? KeptApart{scale.radii, contact_slack * scale.shell} : KeptApart{};
}

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// True if neither partner of a pair can have passed through the other, because contacts hold both from either side and
/// find_crossings stops crossings. If the contact distance is zero, touching surfaces may overlap by rounding.
inline bool is_held_apart(const CollisionSettings& settings, PairState state, const PairScale& scale) {
    return settings.continuous && state == PairState::apart && scale.contact_distance > 0;
}

/// Scale of a pair whose state is known. If a pair is held apart, features become contacts at the contact distance from
/// either side, so the zone need not include depths behind a surface.
inline PairScale pair_scale_as_known(const CollisionSettings& settings, PairState state, PairScale scale) {
    if (is_held_apart(settings, state, scale)) scale.zone = scale.edge_depth;
    return scale;
}

/// Friction and restitution of a pair. The friction coefficients are geometric means of both partners; the restitution
/// is the maximum. For values that a collider does not specify, the values of the body are used.
SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Sum of the displacements of both partners in their frames since their origins were set [m].
inline Real pair_displacement(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    return inputs.body.displacement[first] + (kind == PairKind::collider ? 0 : inputs.body.displacement[second]);
}

/// Travel T0 from which bounds are counted: a distance measured now holds while travel_bound is below T0 plus this
/// distance [m].
inline Real pair_travel_base(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return pairs.travel[p] - 2 * pair_displacement(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]);
}

}  // namespace skerry
