// Bounds on which the lists of the collision stages rest: the distances up to which features still matter. The lists
// are Verlet lists, with a travel in place of a lifetime. For a pair at the present time t,
//
//   D(t)      distance of two of its features, or of its bodies
//   T(t)      sum of both partners' travels, each in its frame (BodyTable), and of the path of one frame as the other
//             sees it; for a collider the body's travel, the path of its frame and the collider's travel
//   d0        sum of both partners' displacements at time 0, when a bound was noted
//   T0 = T(0) - 2 d0                       (pair_travel_base)
//   F = T(t) + closing                     (travel_bound; closing: how much nearer both may come in this step)
//
// 1. Motion:      D(t) >= D(0) - (T(t) - T0). (measure_displacement.h; common motion of both does not count)
// 2. Contact:     a candidate of gap g is a contact of this step only if g <= reach(h, its own relative speed).
// 3. Front:       T(t) + reach <= F for every candidate of the pair: the pair's speeds are at least the candidate's.
// 4. Asleep:      F < T0 + g(0) implies g(t) > reach, by 1 and 3: asleep_until = T0 + g(0), one comparison.
// 5. List:        if all features with D(0) < zone + m are listed, F < T0 + m implies that no other has D(t) < zone or
//                 can be a contact: valid_until = T0 + m.
// 6. Broad phase: suppose all pairs of bodies a, b are listed whose boxes, grown by margins m_a and m_b and by their
//                 contact distances, overlap at time 0. The list holds while F_b < T_b(0) - 2 d_b(0) + m_b for every
//                 body b alone, where T_b includes the path of its frame: body_valid_until.
//
// F covers the step that begins, so that lists need no further margin for it. Travels are sums of rounded numbers; the
// constant part of reach is larger than their rounding by many orders of magnitude.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

// Safety factor, since forces of the step can add to the speeds at its start. A contact that is missed in spite of it
// is found one step later inside the contact shell; find_crossings stops larger motions.
inline constexpr Real speed_safety = 2.0;

// Features whose approach in the step is below this fraction of their distance cannot meet, by a wide margin.
inline constexpr Real slow_fraction = 0.5;

// Fraction of the contact distance that counts as touching already, so that a resting pile keeps its contacts while it
// vibrates.
inline constexpr Real touching_fraction = 0.1;

/// Largest gap that can close within a step of length h [m], at one relative speed or eight.
template <class T>
T reach(Real h, const T& relative_speed, Real gravity, Real contact_distance) {
    return speed_safety * h * (relative_speed + 2 * gravity * h) + touching_fraction * contact_distance;
}

/// Characteristic distances of one pair [m].
struct PairScale {
    Real contact_distance;  // kept between the features: shell and radii
    Real shell;             // kept between the surfaces
    Real edge;              // smaller one of the mean surface edges
    Real face_depth;        // a point at most this deep behind a face is pushed out of it
    Real edge_depth;        // the same depth behind an edge or vertex, and for two edges
    // features nearer than this, on either side, are tested in each step; for points of a collider see face_zone
    Real zone;
    Real radii = 0;  // sum of the radii of round bodies, whose cores are the features
};

// Overlap is rare, because the contact distance keeps surfaces apart. Deeper points may belong to the other side of a
// thin body.
inline constexpr Real face_depth_fraction = 0.25;  // of the edge
inline constexpr Real edge_depth_fraction = 0.02;  // of the edge; the depth is at least the contact distance

/// A point of a collider that is nearer to a face than this, on either side, is tested in each step [m].
inline Real face_zone(const PairScale& scale) {
    return std::max(scale.contact_distance, scale.face_depth);
}

/// Distance that the cores of round bodies keep in the motion of a step. Contacts stop them at the shell, which does
/// not count as near contact. Without a shell surfaces touch up to rounding, and only the cores are tested.
inline KeptApart kept_of_radii(const PairScale& scale) {
    return scale.radii > 0 && scale.shell > 0 ? KeptApart{scale.radii, contact_slack * scale.shell} : KeptApart{};
}

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// True if neither partner of a pair can have come through the other: contacts hold them from both sides, and
/// find_crossings stops crossings. Without a shell touching surfaces may overlap by rounding.
inline bool is_held_apart(const CollisionSettings& settings, PairState state, const PairScale& scale) {
    return settings.continuous && state == PairState::apart && scale.contact_distance > 0;
}

/// Scale of a pair in a known state. Features that are held apart are contacts at the contact distance from either
/// side, so that no depth behind a surface needs a zone.
inline PairScale pair_scale_as_known(const CollisionSettings& settings, PairState state, PairScale scale) {
    if (is_held_apart(settings, state, scale)) scale.zone = scale.edge_depth;
    return scale;
}

/// Friction and restitution of a pair: geometric mean and maximum. A collider without surface properties takes the
/// body's.
SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second);

/// Sum of both partners' displacements in their frames since their origins were set [m].
inline Real pair_displacement(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    return inputs.body.displacement[first] + (kind == PairKind::collider ? 0 : inputs.body.displacement[second]);
}

/// T0: a distance noted now holds while travel_bound is below T0 plus that distance [m].
inline Real pair_travel_base(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return pairs.travel[p] - 2 * pair_displacement(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]);
}

}  // namespace skerry
