// The parts of a step, by file. World::advance (advance.cpp) calls them.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

// step.cpp
/// Lists the stages of the step; the graph derives its edges from the data that they read and write.
void build_step(WorldState& world);

// count_step.cpp
/// Adds a committed step to the sums of the run.
void count_step(const StepScratch& scratch, RunCounters& counters);

// note_seams.cpp
/// After force elements, or rows that join bodies, were added, changed or removed: derives whether the world has force
/// elements, their part in the stable steps, and which bodies are joined.
void note_seams(Model& model);

// stable_steps.cpp
/// Largest step at which the stiffest body is stable, as last evaluated, and the row of that body [s].
Real stable_step(const Model& model, Index* body = nullptr);
/// Stable step of one body: the bound of its elements, reduced for damping (docs/methods/stable_step.md 6.1)
/// and for force elements [s].
Real step_of_body(const Model& model, std::size_t body);
/// Stable step for reports. If all bodies are rigid, and stable at any step, it is the step that is taken [s].
Real told_step(const Model& model, Index* body = nullptr);
/// The longest step that is taken: that of the settings, or the stable step if that is shorter [s].
Real trusted_step(const Model& model, Index* body = nullptr);
/// Longest step that would be taken with one more body that is rigid or implicit [s].
Real step_with_frame(const Model& model);
/// Evaluates the stable step of one body [s].
Real look_at_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                         Column<Real>& stiffness_sum);
/// Evaluates the stable step of every body at once. Bodies whose stable step is much shorter than at rest get clusters
/// where that helps. Returns the energy that the added inertia of these clusters brings into the balance [J].
Real look_at_stable_steps(Model& model, Column<Real>& stiffness_sum);
/// At the end of a round of evaluations beside the steps: bodies take over the results and get clusters as in
/// look_at_stable_steps. Returns the same kind of energy [J].
Real take_over_looks(Model& model, Column<Real>& stiffness_sum);
/// Before a step, in a round of `round` steps: copies the shapes that are to be evaluated beside it.
void keep_shapes(Executor& executor, Model& model, std::uint64_t round, Column<WatchPieces>& pieces_memory);

/// Between steps: clusters follow elements that have stiffened, exactly as they would in the next step. Returns the
/// energy that this brings into the balance [J].
Real follow_stiffening(Model& model);

// choose_clusters.cpp
/// Cost of an element in a step, including its part of nodes and contacts, for choices by cost [ns].
inline constexpr Real element_cost = 70;
/// Whether elements of this world may be implicit.
bool clusters_allowed(const Settings& settings);
/// After a change of the world: chooses the step length and the implicit elements that it needs, by the estimated cost
/// of a simulated second.
void settle_clusters(Model& model, Column<Real>& stiffness_sum);
/// Makes those elements implicit that are not stable at `step` [s], in addition to those that already are. Returns
/// false, and changes nothing, if they would be too many or if steps of the present length `present` [s] cost less.
bool make_implicit(Model& model, std::size_t body, Real step, Real present, std::span<Real> stiffness_sum);
/// Kinetic energy added by the inertia of all implicit elements [J].
Real added_energy(const Model& model);

// advance.cpp
/// Time by which velocities are older than positions, between steps [s]: half a step with symplectic Euler, zero with
/// leapfrog.
Real lag_between_steps(const WorldState& world);

// plan_step.cpp
struct StepPlan {
    Real h = 0;                 // s
    Real steps = 1;             // number of steps of this length to the end of the planned interval
    Real stable = 0;            // the longest step that stability or the settings allow [s]
    Index stiffest = no_index;  // row of BodyTable: the body with the shortest stable step
};
/// Plans the next step of an interval with `left` seconds to go. No step may be longer than `fast_limit` [s].
StepPlan plan_step(const Model& model, Real left, Real fast_limit);
/// Time to the end of the long step of implicit bodies that the next step belongs to; without long steps, `left`, the
/// time to the end of the call [s]. Begins a long step if none is open.
Real left_in_long_step(const Model& model, Real left, LongStepClock& clock);
/// Position of the planned step within the current long step of the implicit bodies.
LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan);
/// Moves the clock on after a step that was taken.
void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock);

// leave_out_step.cpp
/// Whether the planned step would change nothing but time: all bodies rest, nothing scripted moves, and the stages have
/// noted this in an earlier step. If so, colliders and held nodes have the motion of this step.
bool nothing_moves(WorldState& world);
/// For a step that was left out: no contact or attachment force was measured in it.
void forget_forces_of_step(const Model& model, ForceScratch& forces);
/// Calls check_balance, but only once while nothing moves.
void look_at_balance(WorldState& world);

// drift_state.cpp
/// Lets positions, colliders and attachments drift until they are `offset` seconds ahead of the velocities.
void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search);
/// After positions were restored: measures the distance of the nodes from their displacement origins.
void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search);
/// Adds the travel of colliders at their present motion. Bodies get their travel from measure_displacement.
void add_collider_travel(Real seconds, std::span<const Real> extent, ColliderTable& colliders);

// watch_problems.cpp
/// State of the frames of bodies before contacts are solved.
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
/// Copies the data that define the contact problem of this step.
void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                     std::span<const Vec3> position, const KeptFrames& frames, KeptVelocities& kept);
/// Hands the contact problem of the step just taken to its subscriber, if there is one.
void show_contact_problem(const WorldState& world, Real time);

}  // namespace skerry
