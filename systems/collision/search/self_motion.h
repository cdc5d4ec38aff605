// Candidate list of a body with itself: the close pairs of leaves in the tree of the body, and bounds on the motion
// after which the features of a pair must be compared again (docs/methods/collision.md 4.6).
//
// Features of one body that are close to each other mostly move together. So the travel of the body (contact_reach.h),
// which bounds the motion of its fastest node, overestimates the change of their distance. Sharper bounds hold for two
// leaves a, b of the tree, from an earlier time s to the present time t:
//
//   D(t)     distance at time t between a feature of a and a feature of b
//   u_i      displacement x_i(t) - Q x_i(s) of mesh node i without a rotation Q of the whole body; the bounds hold
//            for any Q, and rigid_displacement() fits one
//   U(a, b)  largest |u_i - u_j| for mesh nodes i of a and j of b
//   R(a, b)  upper bound of the gap that can close in the coming step (reach in contact_reach.h), computed like U
//            from velocities in place of displacements
//   M(a, b)  spare distance of the pair of leaves: features that are not in the list satisfy D(s) >= zone + M(a, b)
//   zone     distance below which features are tested in each step (PairScale)
//
// 1. Motion: D(t) >= D(s) - U(a, b). Reason: the two points that are nearest at time t were at least D(s) apart at time
//    s. Apart from the rotation, the vector between them has changed by at most U(a, b).
// 2. Update: a new time t replaces s, and U(a, b) is subtracted from M(a, b). No update is needed while U(root, root) +
//    R(root, root) is below the smallest M.
// 3. Comparison: the list is complete for a step if M > R for all pairs of leaves. The features of pairs with M <= R
//    are compared again, and those with D(t) < zone + max(m, k S, R) are listed; this maximum is the new M. m is
//    SelfMotion::skin, S bounds the relative motion in one step, and k is steps_ahead. The term k S gives fast pairs a
//    larger M, so that they are not compared in every step.
// 4. Rows: only pairs of leaves that are close to each other have a row. The row of the root with itself represents all
//    other pairs. If its M is not above its R, the close pairs are listed again.
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

// Number k of steps for which a spare distance suffices if the parts of the body keep their velocities. With a larger
// number there are fewer comparisons, but each comparison finds more candidates.
inline constexpr Real steps_ahead = 4;
// Pairs of leaves are listed up to this distance, as a multiple of the mean edge length. With a larger number the list
// of pairs is longer, but valid for more steps.
inline constexpr Real listed_edges = 1;
// A search has a fixed cost. So when it compares some pairs of leaves, it also compares all pairs whose spare distance
// is at most this fraction of SelfMotion::skin.
inline constexpr Real renewal_fraction = 0.5;

/// Largest distance between a point in one box and a point in another box.
inline Real farthest(const Aabb& a, const Aabb& b) {
    return (a.upper - b.lower).cwiseMax(b.upper - a.lower).norm();
}

/// One body whose parts move relative to each other, and the length h of the step.
struct SelfMotion {
    const CollisionInputs& inputs;
    Index body;
    PairScale scale;
    Real gravity;  // [m/s^2]
    Real h;        // [s]
    Real skin;     // least spare distance m after a comparison [m]

    /// Row of BvhTable of the root of the body's tree.
    Index root() const { return inputs.body.bvh_nodes[body].begin; }
    /// Bound R(a, b): largest gap between features of two leaves that can close in this step [m].
    Real reach_of(const SelfSearch& self, Index a, Index b) const {
        return reach(h, farthest(self.speed_box[a], self.speed_box[b]), gravity, scale.contact_distance);
    }
    /// Spare distance max(m, k S, R) of two leaves after a new comparison [m]: m is `skin`, k is steps_ahead, S is h
    /// times the largest relative speed of their nodes, and R is reach_of.
    Real margin_of(const SelfSearch& self, Index a, Index b) const {
        const Real speed = farthest(self.speed_box[a], self.speed_box[b]);
        return std::max({skin, steps_ahead * h * speed, reach(h, speed, gravity, scale.contact_distance)});
    }
};

/// SelfMotion of `body` in a step of length `h` [s]. `state`: state of the pair of the body with itself.
/// `longer_motion`: distance by which the skin is increased [m].
inline SelfMotion self_motion_of(const CollisionInputs& inputs, const CollisionSettings& settings, PairState state,
                                 Index body, Real h, Real longer_motion = 0) {
    const PairScale scale = pair_scale(inputs, PairKind::self, body, body);
    return {inputs,           body, pair_scale_as_known(settings, state, scale),
            settings.gravity, h,    settings.pair_skin * scale.edge + longer_motion};
}

/// Makes room for all nodes, features and trees.
void resize(const CollisionInputs& inputs, SelfSearch& self);

/// Returns a lower bound of the spare distances that are left [m] if the candidate list is complete for the step that
/// begins, otherwise 0.
///
/// First compares the largest relative motion of two nodes since the last update with the smallest spare distance. If
/// this test fails, subtracts the relative motion of each pair of leaves from its spare distance, and stores the
/// present positions as those of the last update.
Real update_spare(const SelfMotion& motion, std::span<LeafPair> pairs, SelfSearch& self);

/// Lists the pairs of leaves whose features are compared in this step (LeafPairTable::searched), and sets their new
/// spare distances. The boxes of the tree must be computed from the present positions.
///
/// If `compare_all` is true, all close pairs of leaves are compared; otherwise update_spare must have been called in
/// this step. Removes the candidates of the pairs in `searched`, which the comparison finds again, and of pairs that
/// are no longer close.
void renew_leaf_pairs(const SelfMotion& motion, std::span<const Aabb> box, bool compare_all, Index p, PairTable& pairs);

/// Smallest spare distance [m].
Real smallest_spare(std::span<const LeafPair> pairs);

/// True if the motion of the step is within the bound R of all pairs of leaves, because the nodes move nearly at their
/// present velocities. R exceeds the relative motion at constant velocities by at least the reach at zero speed, so
/// each of two nodes may deviate by half of that reach.
bool moves_as_expected(const SelfMotion& motion, const StepMotion& step);

/// True if features that are not in the candidate list of the body with itself cannot meet during the motion of the
/// step.
bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, std::span<const LeafPair> pairs,
                      SelfSearch& self);

}  // namespace skerry
