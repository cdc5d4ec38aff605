// A step is either committed as a whole or changes nothing. This file declares attempts at a step, their outcomes, and
// the class that restores overwritten data.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"
#include "engine/world/state/clock.h"
#include "engine/world/state/model.h"
#include "systems/dynamics/checks/check_state.h"

namespace skerry {

struct StepPlan;
struct WorldState;

/// Outcome of one attempt at a step of length h. After every outcome but `committed`, the world is again in its state
/// before the attempt. Terms of the diagram:
/// - regular step: StepPlan::regular
/// - too fast: a body with an element that deforms too much in the step
/// - unsolved: a body for which Newton's method fails
/// - region labels: names of contact regions that are equal on all ranks, which exchange them in rounds (RegionLabel)
///
///     attempt -- good ------------------------------------------------------------> committed
///      |---- a rank lacks bodies or region labels of other ranks ----------------> again_over_ranks --------> attempt
///      |---- features that may cross are not in the contact lists ----------------> again_with_longer_lists -> attempt
///      |---- features cross, fewer than 4 attempts of this length ----------------> again_with_crossings ----> attempt
///      |---- features cross; h > regular step / 128 ------------------------------> again_shorter -----------> attempt
///      |---- a body is too fast or unsolved; h > regular step / 1024 -------------> again_shorter -----------> attempt
///      |---- an element turns inside out; h > regular step / 4 -------------------> again_shorter -----------> attempt
///      |---- features cross at the shortest length -------------------------------> again_letting_through ---> attempt
///      '---- not finite, too far; too fast or unsolved at the shortest length ----> refused
enum class StepOutcome {
    committed,
    again_over_ranks,         // the same attempt again, after an exchange of bodies or with more rounds of labels
    again_with_longer_lists,  // the contact lists lacked features that might cross; the next attempt has longer lists
    again_with_crossings,     // surfaces crossed; the next attempt, of equal length, has contacts where they did
    again_shorter,            // the next attempt is half as long, or as long as the rate of deformation allows
    again_letting_through,    // the next attempt accepts crossings and inversions, and reports them
    refused,                  // the step cannot be taken; the cause is in world.scratch.findings
};

/// Limits of the next attempt at a step. They come from attempts at this step and at earlier steps.
struct AttemptLimits {
    // Upper bound of the step length [s]. Crossings, inversions and failures of Newton's method reduce it. It grows
    // after each committed step.
    Real longest = infinity;
    // upper bound of the step length by the speed of deformation and of rotation at joints and ties [s]
    Real slow_enough = infinity;
    Index fastest = no_index;   // row in the undivided world of the body that causes `slow_enough`
    int with_longer_lists = 0;  // number of attempts at this step whose contact lists lacked features that may cross
    int with_crossings = 0;     // number of attempts with this step length in which features crossed
    bool over_ranks = false;    // true after an attempt at this step that all ranks have abandoned together
    // true if the next attempt at this step is the last one, which accepts crossings and inversions
    bool letting_through = false;
    // Cause of the bound `longest`: the last reason, other than speed, for which an attempt was shortened.
    StepLimit limit = StepLimit::inversion;
    Index body = no_index;  // row in the undivided world of the body that caused the bound `longest`

    Real at_most() const { return std::min(longest, slow_enough); }
};

/// Returns the longest step in which the fastest element deforms by at most 90 % of the allowed amount
/// `max_strain_step`, but never less than `stable` / 128 [s]. `stable`: upper bound of the step length by all other
/// limits [s].
Real slow_enough(const StrainRate& fastest, Real max_strain_step, Real stable);

/// Attempts the planned step. Returns the outcome. `attempt`: the limits with which the step was planned; replaced by
/// the limits of the next attempt.
StepOutcome try_step(WorldState& world, const StepPlan& plan, AttemptLimits& attempt);

/// Restores data that an attempt, or a call of advance, overwrites before its success is known. This is the only list
/// of these data:
///
///     data                                      written by             undone by
///     nodes.velocity of attached nodes          drive_nodes            a copy from the start of the attempt
///     bodies.max_speed, bodies.frame_speed      check_state            a copy from the start of the attempt
///     nodes.velocity_next of sleeping bodies    solve_regions          zero, its value as long as they sleep
///     nodes.position, nodes.velocity, time,
///     implicit_nodes.displacement and velocity,
///     rigid_bodies.center, rotation, moments
///     and axes                                  drift_to (leapfrog)    a copy from the start of the call
///     elements.implicit_modulus,
///     clusters.inverse                          stiffen_clusters       nothing: they depend on the shapes at the start
///                                                                      of the attempt, which do not change. But if
///                                                                      - drift_to (leapfrog) changes the shapes:
///                                                                        a copy from the start of the call
///                                                                      - bodies move between ranks, so that forces
///                                                                        are computed again: a copy from before
///                                                                        their first computation
///     pairs, and candidates in them             find_candidates        nothing: results of a search for the positions
///                                                                      at the start of the step stay valid
///     search.memory.body_unmeasured             find_candidates        at the end of the call, bodies whose speeds no
///                                                                      committed step has measured are searched again
///
/// All other state is written only by commit(), and by stages that run only if the step can be committed.
/// tests/scene/transaction_test.cpp compares this list with the writes that the stages declare.
class StepTransaction {
public:
    void begin_try(const Model& model);
    void roll_back_try(Model& model) const;
    /// Store and restore elements.implicit_modulus and clusters.inverse, the assumed stiffness of implicit elements and
    /// the matrices that follow from it.
    void keep_stiffness(const Model& model);
    void restore_stiffness(Model& model) const;
    /// For each body, nonzero if it was asleep when the attempt began.
    std::span<const std::uint8_t> asleep_before() const { return asleep_; }

    /// Store and restore the state at the start of a call of advance. Only leapfrog moves positions before the first
    /// step of a call, so both functions do nothing with symplectic Euler.
    void begin_call(const Model& model, const Clock& clock);
    void roll_back_call(Model& model, Clock& clock) const;

private:
    Column<std::uint8_t> asleep_;           // bodies.asleep
    Column<Real> max_speed_, frame_speed_;  // bodies.max_speed, bodies.frame_speed [m/s]
    Column<Vec3> driven_velocity_;          // velocities of attachments.node at the start of the attempt [m/s]
    Real time_ = 0;                         // time at the start of the call [s]
    Column<Vec3> position_, velocity_;      // positions [m] and velocities [m/s] of all nodes at the start of the call
    Column<Vec3> center_;                   // centres of rigid bodies [m]
    Column<Vec3> moments_;                  // principal moments of inertia of rigid bodies [kg m^2]
    Column<Mat3> rotation_, axes_;          // rotations and principal axes of rigid bodies
    // Displacements and deformation velocities of nodes of implicit bodies [m, m/s]
    Column<Vec3> displacement_, displacement_velocity_;
    Column<ElementLane> modulus_;  // elements.implicit_modulus [Pa]
    Column<Real> inverse_;         // clusters.inverse [1/kg]
};

}  // namespace skerry
