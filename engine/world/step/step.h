// The parts of a step, by file. World::advance (advance.cpp) is made of them.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

// build_step.cpp
/// Lists the stages of the step; the graph takes its edges from what they read and write.
void build_step(WorldState& world);

// count_step.cpp
/// What a committed step adds to the sums of the run.
void count_step(const StepScratch& scratch, RunCounters& counters);

// stable_steps.cpp
/// The largest step that the stiffest body stands, as last watched, and which body (row) that is.
Real stable_step(const Model& model, Index* body = nullptr);
/// What one body stands, s: the bound of its elements, less what its damping takes (docs/methods/stable_step.md 6.1).
Real step_of_body(const Model& model, std::size_t body);
/// The same, for users: where all bodies are rigid, and stand any step, the one that is taken.
Real told_step(const Model& model, Index* body = nullptr);
/// The longest step that is taken: that of the settings, or the stable step where that is shorter.
Real trusted_step(const Model& model, Index* body = nullptr);
/// The same with another body that is rigid or implicit.
Real step_with_frame(const Model& model);
/// Looks at the stable step of one body again, s.
Real look_at_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                         Column<Real>& stiffness_sum);
/// Looks at the stable step of every body at once. Bodies that stand much less than at rest get clusters where that
/// helps; returns the energy that these, by changing what their elements weigh, bring into the balance, J.
Real look_at_stable_steps(Model& model, Column<Real>& stiffness_sum);
/// At the end of a round of looks beside the steps: bodies take over what was found, and get clusters as above. Returns
/// the same energy.
Real take_over_looks(Model& model, Column<Real>& stiffness_sum);
/// Before a step, of a round of so many: keeps the shapes that are to be looked at beside it.
void keep_shapes(Executor& executor, Model& model, std::uint64_t round, Column<WatchPieces>& pieces_memory);

/// Between steps: clusters follow what has stiffened, as they do in each step, and as after it they would in the next.
/// Returns the energy that brings into the balance, J.
Real follow_stiffening(Model& model);

// choose_clusters.cpp
/// ns, what an element takes of a step, with its part of nodes and contacts, as choices count it.
inline constexpr Real element_cost = 70;
/// Whether elements of this world may be implicit.
bool clusters_allowed(const Settings& settings);
/// After a change of the world: decides, by what a simulated second is likely to cost, how long steps are to be, and
/// which elements are implicit so that they can be.
void settle_clusters(Model& model, Column<Real>& stiffness_sum);
/// Makes the elements implicit that do not stand `step` (s) as they are, beside those that are. Returns false, and
/// changes nothing, where that makes too many, or where steps of `present` (s), as they are now, cost less.
bool make_implicit(Model& model, std::size_t body, Real step, Real present, std::span<Real> stiffness_sum);
/// J, what the inertia of all implicit elements adds to the kinetic energy.
Real added_energy(const Model& model);

// advance.cpp
/// Time by which velocities are older than positions, between steps [s]: half a step with symplectic Euler, zero with
/// leapfrog.
Real lag_between_steps(const WorldState& world);

// plan_step.cpp
struct StepPlan {
    Real h = 0;                 // s
    Real steps = 1;             // of this length to the end of what was asked for
    Real stable = 0;            // s, the longest step that stability or the settings allow
    Index stiffest = no_index;  // row of BodyTable: whose stable step is the shortest
};
/// The next step of a call that has `left` seconds to go. No step may be longer than `fast_limit` [s].
StepPlan plan_step(const Model& model, Real left, Real fast_limit);
/// s, to the end of the step of implicit bodies that the next step belongs to, or of a call with `left` seconds to go
/// where there is none. Begins it between two.
Real left_in_long_step(const Model& model, Real left, LongStepClock& clock);
/// Position of the planned step within the current long step of the implicit bodies.
LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan);
/// After a step that was taken.
void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock);

// leave_out_step.cpp
/// Whether the step that is planned would change nothing but time: all bodies rest, what follows scripts stands still,
/// and the stages have seen so in a step before. Then colliders and held nodes have the motion of the step.
bool nothing_moves(WorldState& world);
/// For who sums up what contacts and attachments give: they gave nothing that was measured.
void forget_forces_of_step(const Model& model, ForceScratch& forces);
/// check_balance, but once while nothing moves.
void look_at_balance(WorldState& world);

// drift_state.cpp
/// Lets positions, colliders and attachments drift until they are `offset` seconds ahead of the velocities.
void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search);
/// After positions were put back: how far the nodes are from their displacement origins.
void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search);
/// Colliders have moved for so long at their present motion. Bodies have their travel from measure_displacement.
void add_collider_travel(Real seconds, std::span<const Real> extent, ColliderTable& colliders);

// watch_problems.cpp
/// What moves with a frame, before contacts are solved.
struct KeptFrames {
    std::span<const Vec3> center, angular_momentum;     // RigidBodyTable
    std::span<const Mat3> rotation;                     // RigidBodyTable
    std::span<const Vec3> deforming, deforming_before;  // ImplicitNodeTable

    static KeptFrames bind(const Binder& binder, const RigidBodyTable& rigid, const ImplicitNodeTable& implicit) {
        return {.center = binder.read(rigid.center),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .rotation = binder.read(rigid.rotation),
                .deforming = binder.read(implicit.velocity_next),
                .deforming_before = binder.read(implicit.velocity)};
    }
};
/// Copies what the contact problem of this step is made of.
void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                     std::span<const Vec3> position, const KeptFrames& frames, KeptVelocities& kept);
/// Hands over the contact problem of the step just taken, if somebody wants it.
void show_contact_problem(const WorldState& world, Real time);

}  // namespace skerry
