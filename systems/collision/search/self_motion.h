// Bounds on the relative motion of the parts of one body. They decide how long the candidate list of a body with itself
// is valid.
//
// The travel of the body (contact_reach.h) bounds the motion of its fastest node. Features of one body that are close
// to each other mostly move together, so the travel overestimates the change of their distance. A sharper bound uses
// two nodes a, b of the tree of the body. Let u be the displacement of a mesh node since the last search at time s, and
// U(a, b) the largest |u_i - u_j| for mesh nodes i below a and j below b. Features f below a and g below b satisfy
//
//     D(t) >= D(s) - U(a, b),
//
// because the nearest points at time t have the same weights of mesh nodes at time s. The velocities give the bound
// R(a, b) >= reach (contact_reach.h) in the same way. A search lists all features with D(s) < zone + m + R(a, b), where
// m is the margin of a list. The list is valid while U(a, b) + R(a, b) < m for all a and b that could be near, which
// are those with D(s) < zone + U(a, b) + R(a, b). Both bounds and D(s) are computed from boxes.
#pragma once

#include <limits>

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/inputs/step_motion.h"
#include "systems/collision/tree/box.h"

namespace skerry {

/// PairTable::valid_until of a list that is valid in one step only.
inline constexpr Real this_step_only = std::numeric_limits<Real>::lowest();

// Margin of a list that is valid in one step only, as a fraction of the usual margin. It allows for speeds that the
// contacts of the step add.
inline constexpr Real short_margin = 0.25;

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
    Real skin;     // margin m of the list [m]

    /// Bound R(a, b): distance that features of two parts may close in this step and still become a contact [m].
    Real reach_of(const SelfSearch& self, Index a, Index b) const {
        return reach(h, farthest(self.speed_box[a], self.speed_box[b]), gravity, scale.contact_distance);
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

/// Computes the boxes of the velocities of a body, which SelfMotion::reach_of needs.
void fit_speeds(const CollisionInputs& inputs, Index body, SelfSearch& self);

/// Stores the present positions of a body, from which its candidate list is made.
void store_origin(const CollisionInputs& inputs, Index body, SelfSearch& self);

/// True if the candidate list of the body with itself is complete for the step that begins.
bool holds_for_step(const SelfMotion& motion, SelfSearch& self);

/// True if features that are not in the candidate list of the body with itself cannot meet during the motion of the
/// step. `fresh`: the list was made for this step, and is complete up to the distance zone + m + R(a, b), with the
/// boxes of velocities that the search used.
bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, bool fresh, SelfSearch& self);

}  // namespace skerry
