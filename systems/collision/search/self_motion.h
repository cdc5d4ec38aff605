// Bounds on the relative motion of the parts of one body. They decide how long the candidate list of a body with itself
// is valid.
//
// The travel of the body (contact_reach.h) bounds the motion of its fastest node. Features of one body that are close
// to each other mostly move together, so the travel overestimates the change of their distance. A sharper bound uses
// two nodes a, b of the tree of the body. Let X_i be the position of mesh node i at the last search at time s, and
// u_i = x_i - Q X_i its displacement since then, without a rotation Q of the whole body. Any rotation is permitted;
// motion_since_search computes one that fits. Let U(a, b) be the largest |u_i - u_j| for mesh nodes i below a and j
// below b. Features f below a and g below b satisfy
//
//     D(t) >= D(s) - U(a, b),
//
// because the nearest points at time t have the same weights of mesh nodes at time s. The velocities give the bound
// R(a, b) >= reach (contact_reach.h) in the same way, and the displacements of one step at time s give the bound
// S(a, b) of the relative motion in that step. The margin of a list differs between parts: it is
//
//     M(a, b) = max(m, steps_ahead S(a, b)).
//
// So fast parts have a larger margin than slow parts. A search lists all features with D(s) < zone + max(M, R).
//
// 1. The list is complete for a step if U(a, b) + R(a, b) < M(a, b) for all a and b that could be near, which are those
//    with D(s) < zone + U(a, b) + R(a, b).
// 2. The spare margin is the smallest value of max(M(a, b), D(s) - zone) - U(a, b) for all a and b. The list stays
//    complete while travel_bound is below T0 plus the spare margin, without another comparison of parts
//    (contact_reach.h, 5).
//
// All bounds and D(s) are computed from boxes.
#pragma once

#include <algorithm>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/inputs/step_motion.h"
#include "systems/collision/tree/box.h"

namespace skerry {

// Number of steps for which the margin of a list allows, if the parts of the body keep their velocities. With a larger
// number there are fewer searches, but each search finds more candidates.
inline constexpr Real steps_ahead = 4;

/// Largest distance between a point in one box and a point in another box.
inline Real farthest(const Aabb& a, const Aabb& b) {
    return (a.upper - b.lower).cwiseMax(b.upper - a.lower).norm();
}

/// The parts of one body that move relative to each other, for steps of length h.
struct SelfMotion {
    const CollisionInputs& inputs;
    Index body;
    PairScale scale;
    Real gravity;  // [m/s^2]
    Real h;        // [s]
    Real skin;     // smallest margin m of the list [m]

    /// Bound R(a, b): distance that features of two parts may close in this step and still become a contact [m].
    Real reach_of(const SelfSearch& self, Index a, Index b) const {
        return reach(h, farthest(self.speed_box[a], self.speed_box[b]), gravity, scale.contact_distance);
    }
    /// Margin M(a, b) of the list for features of two parts [m].
    Real margin_of(const SelfSearch& self, Index a, Index b) const {
        return std::max(skin, steps_ahead * farthest(self.origin_step_box[a], self.origin_step_box[b]));
    }
};

/// `state`: state of the pair of the body with itself.
inline SelfMotion self_motion_of(const CollisionInputs& inputs, const CollisionSettings& settings, PairState state,
                                 Index body, Real h) {
    const PairScale scale = pair_scale(inputs, PairKind::self, body, body);
    return {inputs,           body, pair_scale_as_known(settings, state, scale),
            settings.gravity, h,    settings.pair_skin * scale.edge};
}

/// Makes room for all nodes and trees.
void resize(const CollisionInputs& inputs, SelfSearch& self);

/// Stores the present positions and velocities of a body, from which its candidate list is made, and computes the boxes
/// that SelfMotion::reach_of and SelfMotion::margin_of need.
void store_origin(const SelfMotion& motion, SelfSearch& self);

/// Returns the spare margin of the candidate list for the present positions if it exceeds `least`, and otherwise any
/// value up to `least` [m].
Real spare_margin_of(const SelfMotion& motion, Real least, SelfSearch& self);

/// True if the candidate list of the body with itself is complete for the step that begins. spare_margin_of must have
/// been called in this step.
bool holds_for_step(const SelfMotion& motion, SelfSearch& self);

/// True if features that are not in the candidate list of the body with itself cannot meet during the motion of the
/// step. `fresh`: the list was made for this step, and is complete up to the distance zone + max(M, R), with the boxes
/// of velocities that the search used.
bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, bool fresh, SelfSearch& self);

}  // namespace skerry
