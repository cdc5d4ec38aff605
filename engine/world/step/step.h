// The functions that together make up a step, grouped by source file. World::advance (advance.cpp) calls them.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

// step.cpp

/// Lists the stages of the step. The task graph derives its edges from the data that the stages read and write.
void build_step(WorldState& world);
/// Lists the stages again. Must be called after RankState::ranks was changed.
void list_step_again(WorldState& world);

// count_step.cpp

/// Computes the counters of one step from the results of its contact solve. Their energies are zero, because commit()
/// adds the energies of a step to the run itself. `unstrained`: StepFindings::unstrained.
RunCounters count_step(const ContactTable& contacts, const RegionTable& regions, const ContactMeasures& measures,
                       const NewtonCounts& newton, Index unstrained);
/// Adds the sums of `from` to those of `into`, except for sums of energy. Each maximum in `into` becomes the
/// greater of both maxima.
void add_counters(const RunCounters& from, RunCounters& into);
/// Adds a committed step to the counters of the run.
void count_committed_step(const RunCounters& step, RunCounters& run);
/// Energy that a step dissipated [J].
Real dissipated_in(const StepFindings& findings);

// ranks/name_body.cpp

/// Handle and name of a body for reports.
struct NamedBody {
    BodyHandle body{};  // handle of no body if the object is a mesh collider
    std::string name;
};
/// Returns the handle and name of a body, even if only other ranks hold it. `world_row`: row of the body in the
/// undivided world; without ranks, its row in BodyTable.
NamedBody name_body(const WorldState& world, Index world_row);
/// Returns the row in the undivided world of the body with the shortest stable step. `row`: result of the argument
/// `body` of stable_step.
Index world_row_of_stiffest(const WorldState& world, Index row);

// ranks/lead_ghosts.cpp

/// Computes BodyTable::ghost. Must be called after a change of bodies, of the ranks that own them, or of the ranks that
/// hold copies of them.
void note_ghosts(WorldState& world);
/// Must be called at the end of a round, after reduce_limits. For each body with new implicit elements, sends its data
/// to the ranks with copies of it. From then on these ranks compute the forces of their copy themselves.
void send_clustered_bodies(WorldState& world);
/// Lists the stage that sends predicted velocities of bodies to ranks with a led ghost, a copy for which only the owner
/// of the body computes forces.
void list_led_ghosts(WorldState& world, TaskGraph& graph);

// ranks/join_records.cpp

/// Adds the sums of all ranks since the last call to the records of the run. Without ranks it does nothing. The last
/// digits of sums depend on the number of ranks; the motion does not depend on these sums.
void join_records(WorldState& world);
/// Calls join_records, and makes the report of a call of advance equal on all ranks.
void join_reports(WorldState& world, StepReport& report);

// ranks/sleep_over_ranks.cpp

/// Lists the stages by which sets of touching bodies on several ranks fall asleep and wake as in an undivided world.
void list_wakes(WorldState& world, TaskGraph& graph);  // finds bodies that this rank wakes; runs before the reduction
void list_joined_wakes(WorldState& world,
                       TaskGraph& graph);                    // collects bodies that any rank wakes; before wake_bodies
void list_joined_sets(WorldState& world, TaskGraph& graph);  // joins sets of touching bodies; runs before rest_bodies

// ranks/reduce_findings.cpp

/// Lists the stage that combines the findings of all ranks. Lists nothing if this process simulates the whole world.
void list_reduction(WorldState& world, TaskGraph& graph);
/// Must be called before the stages run. Makes all ranks agree whether the step is skipped (StepScratch::skipped), and
/// whether a body is too far from the origin. Communicates only if, according to the last attempt, one of the two is
/// possible. Without ranks it does nothing.
void agree_to_start(WorldState& world);

// ranks/reduce_limits.cpp

/// Computes Model::of_ranks from the bodies of all ranks. Sets Model::forced if any rank has force elements. Without
/// ranks it does nothing.
void reduce_limits(WorldState& world);
/// Returns the fastest deformation of all ranks, with the row of its body in the undivided world. `own`: fastest
/// deformation of this rank, with the row in BodyTable. Without ranks it returns `own`.
StrainRate fastest_of_ranks(WorldState& world, const StrainRate& own);

// ranks/regions

/// The next three functions list the stages in which ranks exchange contacts and results of regions whose bodies belong
/// to several ranks. They list nothing if this process simulates the whole world.
void list_row_exchange(WorldState& world, TaskGraph& graph);
void list_result_exchange(WorldState& world, TaskGraph& graph);
void list_rows_taken_back(WorldState& world, TaskGraph& graph);

// held_depth.cpp

/// Largest depth of a held surface node inside an analytic collider at the present time. `all`: if false, pairs are
/// skipped in which neither the collider nor an attachment of the body moves, because their depth has not changed.
HeldDepth held_in_shapes(const WorldState& world, bool all);
/// Largest depth, at the present time, of a held node of one body or mesh collider behind a triangle of another one, if
/// the three nodes of the triangle are held too. Refits the bounding volume hierarchies of the objects that it
/// compares.
HeldDepth held_in_surfaces(WorldState& world);

// note_forces.cpp

/// Computes Model::forced, force_rate, force_damping, force_drag and the derived columns of force elements. Must be
/// called after force elements, or bodies on which they act, were added, changed or removed.
void note_forces(Model& model);
/// Computes Model::force_rate, force_damping and force_drag for the present positions.
void note_force_rates(Model& model);
/// Must be called before steps. Computes Model::links again if rows that join bodies have changed, Model::forced if the
/// last force element was removed, and Model::force_rate if it depends on positions.
void note_changed_seams(Model& model);

// stable_steps.cpp

/// Shortest of the stable steps of all bodies, as last evaluated [s]. `body`: receives the row of the body with this
/// step; no_index if the step comes from Model::of_ranks, which is computed from the bodies of all ranks.
Real stable_step(const Model& model, Index* body = nullptr);
/// True if strain has shortened the stable step of a body.
bool is_strained(const Model& model, std::size_t body);
/// Stable step of one body [s]. It is the stable step of the body's elements, shortened because of damping
/// (docs/methods/stable_step.md 6.1) and of force elements.
Real step_of_body(const Model& model, std::size_t body);
/// Stable step for reports [s]. If all bodies are rigid or implicit, and therefore stable at any step length, it is the
/// result of trusted_step.
Real reported_step(const Model& model, Index* body = nullptr);
/// The longest step that is taken [s]: the shortest of these three. First, the stable step times Tuning::step_safety.
/// Second, Settings::step_size if given, otherwise 1/120 s if the world has rigid or implicit bodies. Third,
/// Settings::implicit_step if it is above 0 and the world has implicit bodies.
Real trusted_step(const Model& model, Index* body = nullptr);
/// Longest step that would be taken after a rigid or implicit body is added [s].
Real step_with_frame(const Model& model);
/// Evaluates the stable step [s] of one body for the node positions `position`. `stiffness_sum`: working memory, by
/// node.
Real evaluate_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                          Column<Real>& stiffness_sum);
/// Evaluates the stable steps of all bodies at once. Makes elements of a body implicit if strain has made its stable
/// step much shorter than the shortest stable step at rest of all bodies, and if this reduces the computing time.
/// Returns the energy that the inertia of new clusters adds to the balance [J].
Real evaluate_stable_steps(Model& model, Column<Real>& stiffness_sum);
/// Ends a round in which stable steps were evaluated in parallel with the steps. The new stable steps are used from now
/// on. Elements become implicit as in evaluate_stable_steps. Returns the energy that the inertia of new clusters adds
/// to the balance [J].
Real use_evaluated_steps(Model& model, Column<Real>& stiffness_sum);
/// Must be called before each step. Copies the shapes of some bodies; the stable steps for these shapes are then
/// evaluated in parallel with the step. In a round of `round` steps, all bodies are evaluated.
void store_shapes(Executor& executor, Model& model, std::uint64_t round);
/// Computes StepWatch::first_piece, by which the stable-step checks of a round are spread over its steps. With ranks it
/// is collective the first time, and after a round in which elements of some rank became implicit.
void count_pieces(WorldState& world);

/// Updates the matrices of clusters whose elements have stiffened, by the test that the next step would also apply.
/// Velocities do not change, so the larger inertia adds kinetic energy. Returns this energy, which the balance must
/// count as work [J].
Real follow_stiffening(Model& model);

// yield_blocks.cpp

/// Plastic flow at the present positions: moves the elastic strain of elements in a range of blocks back to the yield
/// surface (radial return). Does nothing if no material yields. `elements`: all elements, or Model::awake_elements() to
/// leave out elements that steps skip. Returns the dissipated energy [J].
Real yield_blocks(WorldState& world, const ElementInputs& elements, Range blocks);
/// True if an element of a body has flowed plastically.
bool has_flowed(const Model& model, std::size_t body);
/// Undoes the plastic flow of the elements of a body.
void undo_flow(Model& model, std::size_t body);

// choose_clusters.cpp

/// Computing time of an element in a step, including its share of nodes and contacts [ns]. It serves only to compare
/// costs.
inline constexpr Real element_cost = 70;
/// True if the settings allow clusters, so that elements of explicit bodies may be integrated implicitly.
bool clusters_allowed(const Settings& settings);
/// Must be called after a change of the world. Chooses the step length and the implicit elements for which the
/// estimated computing time of a simulated second is smallest.
void settle_clusters(Model& model, Column<Real>& stiffness_sum);
/// Makes more elements of a body implicit: those that are unstable at the step length `step` [s]. Returns false, and
/// changes nothing, in three cases: the body must not have clusters, the clusters would be too large or too heavy, or
/// steps of the present length `present_step` [s] take less computing time.
bool make_implicit(Model& model, std::size_t body, Real step, Real present_step, std::span<Real> stiffness_sum);
/// Kinetic energy of the inertia that all implicit elements add to their nodes [J].
Real added_energy(const Model& model);

// advance.cpp

/// Time by which velocities are older than positions between two steps: half a step with symplectic Euler, zero with
/// leapfrog [s].
Real lag_between_steps(const WorldState& world);

// plan_step.cpp
struct StepPlan {
    Real h = 0;       // s
    Real steps = 1;   // number of steps of length `h` until the end of the planned interval
    Real stable = 0;  // longest step that stability and the settings allow [s]
    // Length `stable`, or less if bodies with joints or ties would rotate too far in such a step (step_of_turns) [s].
    // Shorter attempts have at least a certain fraction of this length.
    Real regular = 0;
    // row in BodyTable of the body with the shortest stable step; no_index if this step comes from Model::of_ranks
    Index stiffest = no_index;
};
/// Plans the next step of an interval that ends in `remaining` seconds. The step is at most `fast_limit` seconds long.
StepPlan plan_step(const Model& model, Real remaining, Real fast_limit);
/// Greatest angular speed of a body with a joint or tie [rad/s]. `body`: set to the row of this body in BodyTable.
Real fastest_spin(const Model& model, Index* body = nullptr);
/// Longest step in which no body with a joint or tie rotates by more than a small angle, but at most `shorter_than`
/// [s]. `fastest`: set only if the result is shorter than `shorter_than`, to the row in BodyTable of the body that
/// rotates fastest; no_index if its speed comes from Model::of_ranks.
Real step_of_turns(const Model& model, Real shorter_than, Index& fastest);
/// True if a force that depends on the motion acts on an implicit body, or a cable runs over one. Such forces must be
/// evaluated in every step, so implicit bodies then take no long steps.
bool forces_follow_implicit_bodies(const Model& model);
/// Returns the time until the end of the long step that contains the next step [s]. Begins a long step if there is
/// none. In worlds without long steps, returns `remaining`, the time until the end of the call.
Real time_to_end_of_long_step(const Model& model, Real remaining, LongStepClock& clock);
/// Returns the length of the current long step of the implicit bodies, and whether the planned step is the first or the
/// last step within this long step.
LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan);
/// Updates the time that is left in the current long step, after a committed step. Ends the long step after its last
/// step.
void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock);

// leave_out_step.cpp

/// True if the planned step would change nothing but time: all bodies sleep, no script moves anything, and no contacts
/// or speeds remain from earlier steps. If it returns true, it has computed the motion of colliders and held nodes for
/// this step, as skipped stages would do.
bool nothing_moves(WorldState& world);
/// Sets the contact and attachment forces to zero after a skipped step, in which no stage measured them.
void forget_forces_of_step(const Model& model, ForceScratch& forces);
/// Checks the balance of energy and momentum (check_balance), unless nothing has moved since the last check.
void check_balance_after_motion(WorldState& world);

// find_self_crossings.cpp

/// Updates the list of bodies whose surface crosses itself (WorldReport::self_crossings) for the present positions.
/// Skips rigid, sleeping and unstrained bodies, whose crossings cannot have changed, and ghosts. Overwrites the
/// bounding boxes of `model.bvh`. `places`: working memory with a row for each body.
void find_self_crossings(Executor& executor, Model& model, Real time, Column<Index>& places,
                         std::vector<SelfCrossing>& crossings);

// drift_state.cpp

/// Moves positions, colliders and attachments by a drift. Afterwards the positions are `offset` seconds ahead of the
/// velocities.
void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search);
/// Must be called after positions were restored. Measures again how far nodes are from NodeTable::displacement_origin,
/// where BodyTable::displacement was last zero.
void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search);
/// Adds to ColliderTable::travel the largest distance that a point of the collider near a body moves in `seconds` [s]
/// at the present velocity. `extent`: for each collider, largest distance of such points from its origin [m]. The
/// travel of bodies is measured by measure_displacement.
void add_collider_travel(Real seconds, std::span<const Real> extent, ColliderTable& colliders);

// watch_problems.cpp

/// State of rigid bodies and of the frames of implicit bodies, and deformation velocities of implicit bodies, before
/// contacts are solved.
struct KeptFrames {
    std::span<const Vec3> center, angular_momentum;     // RigidBodyTable
    std::span<const Mat3> rotation, axes;               // RigidBodyTable
    std::span<const Vec3> deforming, deforming_before;  // ImplicitNodeTable

    static KeptFrames bind(const Binder& binder, const RigidBodyTable& rigid, const ImplicitNodeTable& implicit) {
        return {.center = binder.read(rigid.center),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .rotation = binder.read(rigid.rotation),
                .axes = binder.read(rigid.axes),
                .deforming = binder.read(implicit.velocity_next),
                .deforming_before = binder.read(implicit.velocity)};
    }
};
/// Copies the data from which the contact problem of this step can be exported.
void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                     std::span<const Vec3> position, const KeptFrames& frames, KeptVelocities& kept);
/// Passes the contact problem of the last step to the function of the subscriber. Does nothing without a subscriber.
void show_contact_problem(const WorldState& world, Real time);

}  // namespace skerry
