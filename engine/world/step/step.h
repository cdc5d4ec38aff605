// The parts of a step, grouped by source file. World::advance (advance.cpp) calls them.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

// step.cpp

/// Lists the stages of the step. The task graph derives its edges from the data that the stages read and write.
void build_step(WorldState& world);

// count_step.cpp

/// Adds a committed step to the counters of the run.
void count_step(const StepScratch& scratch, RunCounters& counters);

// note_forces.cpp

/// After force elements, or bodies with any, were added, changed or removed: derives Model::forced and force_rate.
void note_forces(Model& model);
/// Before steps: derives Model::links if rows that join bodies have changed, and Model::forced if the last force
/// element is gone.
void note_changed_seams(Model& model);

// stable_steps.cpp

/// Shortest of the stable steps of all bodies, as last evaluated [s]. `body`: receives the row of this body.
Real stable_step(const Model& model, Index* body = nullptr);
/// Stable step of one body: the bound of its elements, reduced for damping (docs/methods/stable_step.md 6.1) and for
/// force elements [s].
Real step_of_body(const Model& model, std::size_t body);
/// Stable step for reports [s]. If all bodies are stable at any step, because they are rigid or implicit, it is the
/// result of trusted_step.
Real told_step(const Model& model, Index* body = nullptr);
/// The longest step that is taken: the stable step, or the limit of the settings if this limit is shorter [s].
Real trusted_step(const Model& model, Index* body = nullptr);
/// Longest step that would be taken if a rigid or implicit body were added [s].
Real step_with_frame(const Model& model);
/// Evaluates the stable step of one body for the given node positions [s].
Real look_at_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                         Column<Real>& stiffness_sum);
/// Evaluates the stable steps of all bodies at once. A body whose stable step is much shorter than at rest gets
/// clusters where they help. Returns the energy that the inertia of new clusters adds to the balance [J].
Real look_at_stable_steps(Model& model, Column<Real>& stiffness_sum);
/// Ends a round in which stable steps were evaluated in parallel with the steps. Bodies use the new stable steps, and
/// get clusters as in look_at_stable_steps. Returns the energy that the inertia of new clusters adds to the balance
/// [J].
Real take_over_looks(Model& model, Column<Real>& stiffness_sum);
/// Must be called before each step. Copies the shapes of some bodies, whose stable steps are then evaluated in parallel
/// with this step. After a round of `round` steps, all bodies have been evaluated.
void keep_shapes(Executor& executor, Model& model, std::uint64_t round, Column<WatchPieces>& pieces_memory);

/// Updates the matrices of clusters whose elements have stiffened, exactly as the next step would do it. Returns the
/// energy that this update adds to the balance [J].
Real follow_stiffening(Model& model);

// choose_clusters.cpp

/// Cost of an element in a step, including its share of nodes and contacts [ns]. It serves only to compare costs.
inline constexpr Real element_cost = 70;
/// True if elements of this world may be implicit.
bool clusters_allowed(const Settings& settings);
/// Must be called after a change of the world. Chooses the step length and the implicit elements with the least
/// estimated cost of a simulated second.
void settle_clusters(Model& model, Column<Real>& stiffness_sum);
/// Makes the elements of a body implicit that are unstable at `step` [s], in addition to its present implicit elements.
/// Returns false, and changes nothing, if there would be too many of them, or if steps of the present length `present`
/// [s] cost less.
bool make_implicit(Model& model, std::size_t body, Real step, Real present, std::span<Real> stiffness_sum);
/// Kinetic energy added by the inertia of all implicit elements [J].
Real added_energy(const Model& model);

// advance.cpp

/// Time by which velocities are older than positions between two steps: half a step with symplectic Euler, zero with
/// leapfrog [s].
Real lag_between_steps(const WorldState& world);

// plan_step.cpp
struct StepPlan {
    Real h = 0;                 // s
    Real steps = 1;             // number of steps of length `h` to the end of the planned interval
    Real stable = 0;            // the longest step that stability or the settings allow [s]
    Index stiffest = no_index;  // row of BodyTable: the body with the shortest stable step
};
/// Plans the next step of an interval, of which `left` seconds remain. The step is at most `fast_limit` long [s].
StepPlan plan_step(const Model& model, Real left, Real fast_limit);
/// Time to the end of the long step that contains the next step. Begins a long step if there is none. In worlds without
/// long steps it is `left`, the time to the end of the call [s].
Real left_in_long_step(const Model& model, Real left, LongStepClock& clock);
/// Position of the planned step within the current long step of the implicit bodies.
LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan);
/// Updates the clock of long steps after a committed step.
void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock);

// leave_out_step.cpp

/// True if the planned step would change nothing but time: all bodies sleep, no script moves anything, and an earlier
/// step has left no contacts or speeds. Also sets the motion of colliders and held nodes for this step.
bool nothing_moves(WorldState& world);
/// Clears the contact and attachment forces of a skipped step, in which no stage measured them.
void forget_forces_of_step(const Model& model, ForceScratch& forces);
/// Calls check_balance, unless nothing has moved since the last call.
void look_at_balance(WorldState& world);

// drift_state.cpp

/// Moves positions, colliders and attachments by a drift, until they are `offset` seconds ahead of the velocities.
void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search);
/// Must be called after positions were restored. Measures the distance of each node from its displacement origin again.
void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search);
/// Adds the travel of colliders at their present velocities over `seconds`. The travel of bodies is found by
/// measure_displacement.
void add_collider_travel(Real seconds, std::span<const Real> extent, ColliderTable& colliders);

// watch_problems.cpp

/// State of rigid bodies, and deformation of implicit bodies, before contacts are solved.
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
/// Passes the contact problem of the last step to its subscriber, if there is one.
void show_contact_problem(const WorldState& world, Real time);

}  // namespace skerry
