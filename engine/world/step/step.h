// The functions that together make up a step, grouped by source file. World::advance (advance.cpp) calls them.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

// step.cpp

/// Adds the stages of the step to the task graph. The graph derives its edges from the data that the stages read and
/// write.
void build_step(WorldState& world);
/// Builds the task graph of the step again. Must be called after RankState::ranks was changed, because other ranks need
/// other stages.
void list_step_again(WorldState& world);

// count_step.cpp

/// Computes the counters of one step from the results of its contact solve. Their energies are zero, because commit()
/// adds the energies of a step to the run itself. `unstrained`: StepFindings::unstrained.
RunCounters count_step(const ContactTable& contacts, const RegionTable& regions, const ContactMeasures& measures,
                       const NewtonCounts& newton, Index unstrained);
/// Adds the counts in `from` to those in `into`, but not the energies. Each maximum in `into` becomes the greater of
/// the two maxima.
void add_counters(const RunCounters& from, RunCounters& into);
/// Adds a committed step to the counters of the run.
void count_committed_step(const RunCounters& step, RunCounters& run);
/// Energy that a step has dissipated in contacts, materials, dampers and cables, and by putting bodies to rest [J].
Real dissipated_in(const StepFindings& findings);

// ranks/name_body.cpp

/// Handle and name of a body for reports.
struct NamedBody {
    BodyHandle body{};  // default handle if the object is a mesh collider
    std::string name;
};
/// Returns the handle and name of a body, even if this rank has no copy of it. `world_row`: row of the body in the
/// undivided world (the row it would have if one process simulated all bodies).
NamedBody name_body(const WorldState& world, Index world_row);
/// Returns the row in the undivided world of the body with the shortest stable step. `row`: the row that stable_step
/// has written to its argument `body`.
Index world_row_of_stiffest(const WorldState& world, Index row);

// ranks/lead_ghosts.cpp

/// Computes BodyTable::ghost. Must be called after a change of bodies, of the ranks that own them, or of the ranks that
/// hold copies of them.
void note_ghosts(WorldState& world);
/// Sends the data of each body with new implicit elements to the ranks that have copies of it. From then on these ranks
/// compute the forces on their copies themselves. Must be called at the end of a round of steps (steps_per_round in
/// advance.cpp), after reduce_limits.
void send_clustered_bodies(WorldState& world);
/// Lists the stage that sends the predicted velocities of bodies to ranks with led ghosts of them. A led ghost is a
/// copy of a body that needs these velocities, because only the owner of the body computes forces.
void list_led_ghosts(WorldState& world, TaskGraph& graph);

// ranks/join_records.cpp

/// Adds the sums that all ranks have collected since the last call (RankShare) to the records of the run. Without ranks
/// it does nothing. The last digits of the records depend on the number of ranks, but the motion does not depend on the
/// records.
void join_records(WorldState& world);
/// Calls join_records, and makes the report of a call of advance equal on all ranks.
void join_reports(WorldState& world, StepReport& report);

// ranks/sleep_over_ranks.cpp

/// The next three functions list stages. They make sets of touching bodies on several ranks fall asleep and wake as in
/// an undivided world.
void list_wakes(WorldState& world, TaskGraph& graph);  // finds bodies that this rank wakes; runs before the reduction
void list_joined_wakes(WorldState& world,
                       TaskGraph& graph);                    // collects bodies that any rank wakes; before wake_bodies
void list_joined_sets(WorldState& world, TaskGraph& graph);  // joins sets of touching bodies; runs before rest_bodies

// ranks/reduce_findings.cpp

/// Lists the stage that combines the findings of all ranks. Lists nothing if this process simulates the whole world.
void list_reduction(WorldState& world, TaskGraph& graph);
/// Makes all ranks agree whether the step is skipped (StepScratch::skipped), and whether a body is too far from the
/// origin. Must be called before the stages run. Communicates only if the last attempt has shown that one of the two is
/// possible. Without ranks it does nothing.
void agree_to_start(WorldState& world);

// ranks/reduce_limits.cpp

/// Computes Model::of_ranks, the limits of the step length, from the bodies of all ranks. Sets Model::forced to true if
/// any rank has force elements. Without ranks it does nothing.
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

/// Largest depth of a held surface node inside an analytic collider at the present time. A held node is a node whose
/// motion is prescribed. `all`: if false, skips pairs in which neither the collider nor an attachment of the body
/// moves, because their depth has not changed.
HeldDepth held_in_shapes(const WorldState& world, bool all);
/// Largest depth of a held node of one body or mesh collider inside another one at the present time. Counts only nodes
/// whose nearest triangle has three held nodes, because contacts can move all other triangles. Refits the bounding
/// volume hierarchies of the objects that it compares.
HeldDepth held_in_surfaces(WorldState& world);

// note_forces.cpp

/// Computes Model::forced, force_rate, force_damping, force_drag and the derived columns of force elements. Must be
/// called after force elements, or bodies on which they act, were added, changed or removed.
void note_forces(Model& model);
/// Computes Model::force_rate, force_damping and force_drag for the present positions.
void note_force_rates(Model& model);
/// Must be called before steps. Updates results that may be out of date:
/// - Model::forced, if the last force element was removed
/// - Model::force_rate, if it depends on positions
/// - Model::links and set_of_feature, if rows that join bodies, or surface sets, have changed
void note_changed_seams(Model& model);

// stable_steps.cpp

/// Shortest stable step of all bodies, from the last evaluation of each body [s]. `body`: set to the row of the body
/// with this step; no_index if the step comes from Model::of_ranks, and so perhaps from a body of another rank.
Real stable_step(const Model& model, Index* body = nullptr);
/// True if strain has shortened the stable step of a body by more than a tenth.
bool is_strained(const Model& model, std::size_t body);
/// Stable step of one body [s]: the stable step of its elements, shortened for damping (docs/methods/stable_step.md
/// 6.1) and for the force elements that act on it.
Real step_of_body(const Model& model, std::size_t body);
/// Stable step for reports [s]. If it is infinite in a world with rigid or implicit bodies, the upper bound of the step
/// length (longest_allowed_step) is returned instead.
Real reported_step(const Model& model, Index* body = nullptr);
/// Upper bound of the step length [s], the least of
/// - the stable step times Tuning::step_safety,
/// - Settings::step_size if it is given, otherwise 1/120 s if the world has rigid or implicit bodies,
/// - Settings::implicit_step if it is above 0 and the world has implicit bodies.
Real longest_allowed_step(const Model& model, Index* body = nullptr);
/// Upper bound that the step length would have after a rigid or implicit body is added [s].
Real step_with_frame(const Model& model);
/// Evaluates the stable step [s] of one body for the node positions `position`. `stiffness_sum`: working memory, by
/// node.
Real evaluate_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                          Column<Real>& stiffness_sum);
/// Evaluates the stable steps of all bodies at once. Makes elements of a body implicit if strain has made its stable
/// step much shorter than the shortest stable step at rest of all bodies, and if this reduces the computing time.
/// Returns the energy that the inertia of new clusters adds to the balance [J].
Real evaluate_stable_steps(Model& model, Column<Real>& stiffness_sum);
/// Puts into use the stable steps that were evaluated, body by body, during the steps of a round. Must be called at its
/// end. Makes elements implicit like evaluate_stable_steps, and returns the same energy [J].
Real use_evaluated_steps(Model& model, Column<Real>& stiffness_sum);
/// Must be called before each step. Copies the shapes of the bodies whose stable steps are evaluated next, in parallel
/// with this step and perhaps later ones. Each body gets its turn once in a round of `round` steps.
void store_shapes(Executor& executor, Model& model, std::uint64_t round);
/// Counts the pieces into which the computation of stable steps is divided, so that it can be spread evenly over the
/// steps of a round. The result is StepWatch::first_piece: for each body, the number of pieces of all bodies before it.
///
/// With ranks, two kinds of calls are collective, which means that all ranks must make them together: the first call,
/// and the call after a round in which elements of some rank became implicit.
void count_pieces(WorldState& world);

/// Updates the matrices of clusters whose elements have stiffened. Otherwise the stage stiffen_clusters would do this
/// in the next step. Velocities do not change, so the larger inertia adds kinetic energy. Returns this energy, which
/// the balance must count as work [J].
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

/// Computing time of one element in a step, with its share of the time for nodes and contacts [ns]. It is only compared
/// with other computing times.
inline constexpr Real element_cost = 70;
/// True if the settings allow clusters, so that elements of explicit bodies may be integrated implicitly.
bool clusters_allowed(const Settings& settings);
/// Must be called after a change of the world. Chooses the step length and the implicit elements for which the
/// estimated computing time of a simulated second is smallest.
void settle_clusters(Model& model, Column<Real>& stiffness_sum);
/// Makes those elements of a body implicit that are unstable at the step length `step` [s]. Returns false, and changes
/// nothing, if
/// - the body must not have clusters,
/// - the clusters would have too many nodes or add too much inertia, or
/// - a simulated second costs less computing time with steps of the present length `present_step` [s].
bool make_implicit(Model& model, std::size_t body, Real step, Real present_step, std::span<Real> stiffness_sum);
/// Kinetic energy of the additional inertia that implicit elements give their nodes [J].
Real added_energy(const Model& model);

// advance.cpp

/// Time by which velocities are older than positions between two steps: half a step with symplectic Euler, zero with
/// leapfrog [s].
Real lag_between_steps(const WorldState& world);

// plan_step.cpp
struct StepPlan {
    Real h = 0;       // s
    Real steps = 1;   // number of steps of length `h` in the planned interval, this step included
    Real stable = 0;  // longest step that stability and the settings allow (longest_allowed_step) [s]
    // Length `stable`, or a shorter one, so that no body with a joint or tie rotates too far (step_of_turns) [s].
    // Attempts are repeated with shorter steps down to a certain fraction of this length (most_shortening in
    // transaction.cpp).
    Real regular = 0;
    // row in BodyTable of the body with the shortest stable step; no_index if this step comes from Model::of_ranks
    Index stiffest = no_index;
};
/// Plans the next step of an interval that ends in `remaining` seconds. `fast_limit`: upper bound of the step length
/// from earlier attempts and from the speed of deformation [s].
StepPlan plan_step(const Model& model, Real remaining, Real fast_limit);
/// Greatest angular speed of a body with a joint or tie [rad/s]. `body`: set to the row of this body in BodyTable.
Real fastest_spin(const Model& model, Index* body = nullptr);
/// Longest step in which no body with a joint or tie rotates by more than a small angle, but at most `shorter_than`
/// [s]. `fastest`: set only if the result is shorter, to the row in BodyTable of the body that rotates fastest;
/// no_index if Model::of_ranks gives its speed.
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
/// Must be called after a committed step. Reduces the time that remains in the current long step, and ends the long
/// step after its last step.
void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock);

// leave_out_step.cpp

/// True if the planned step would change nothing but the time: all bodies sleep, no script moves anything, and no
/// contacts or speeds remain from earlier steps. It then also computes the motion of colliders and held nodes in this
/// step, because the stages that do this are skipped.
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

/// Makes a drift of leapfrog, forwards or backwards in time: moves bodies with their present velocities, and colliders
/// and attachments along their scripts. Afterwards the positions are `offset` seconds ahead of the velocities.
void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search);
/// Computes BodyTable::displacement again after positions were restored. It is the largest displacement of a node,
/// relative to the moving frame of the body, since this column was last zero. NodeTable::displacement_origin contains
/// the positions at that time.
void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search);
/// Adds to ColliderTable::travel an upper bound of the path of those points of a collider that are near a body, in the
/// time `seconds` [s] at its present velocity. `extent`: for each collider, the largest distance of these points from
/// its origin [m]. measure_displacement does this for bodies.
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
