// All or nothing: how a step is tried, how a try ends, and how overwritten data are restored.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "components/column.h"
#include "components/types.h"
#include "engine/world/state/clock.h"
#include "engine/world/state/model.h"
#include "systems/dynamics/checks/check_state.h"

namespace skerry {

struct StepPlan;
struct WorldState;

/// Outcome of one try of a step. After all but `committed` the world is in its state before the try.
///
///     try -- good ---------------------------------------------------------------> committed
///      |---- features cross, fewer than 4 tries of this length ------------------> again_with_crossings --> try
///      |---- features cross; h > stable step / 128 ------------------------------> again_shorter ---------> try
///      |---- a body is too fast or unsolved; h > stable step / 1024 -------------> again_shorter ---------> try
///      |---- an element turns inside out; h > stable step / 4 -------------------> again_shorter ---------> try
///      |---- features cross at the shortest length ------------------------------> again_letting_through -> try
///      '---- not finite, too far; too fast or unsolved at the shortest length ---> refused
enum class StepOutcome {
    committed,
    again_with_longer_lists,  // repeat the same try: features near enough to cross were not in the lists
    again_with_crossings,     // crossing features are contacts of the next try, which has the same length
    again_shorter,            // the next try is half as long, or as long as the speed limit allows
    again_letting_through,    // the next try accepts crossings and inversions, and reports them
    refused,                  // world.scratch.findings name the cause
};

/// Results of the tries of the present and earlier steps that matter for the next try.
struct Tries {
    Real longest = std::numeric_limits<Real>::infinity();      // grows again step by step [s]
    Real slow_enough = std::numeric_limits<Real>::infinity();  // bound at the last rate of deformation [s]
    Index fastest = no_index;                                  // row of BodyTable: the body that deforms fastest
    int with_longer_lists = 0;                                 // tries of this step that could not be judged
    int with_crossings = 0;                                    // tries of this step at its present length
    bool letting_through = false;                              // the next try is the last
    // cause of `longest`: that of the last try that was given up for a shorter one for a reason other than speed
    StepLimit limit = StepLimit::inversion;
    Index body = no_index;  // row of BodyTable

    Real at_most() const { return std::min(longest, slow_enough); }
};

/// Longest step at this rate of deformation, but never less than the shortest length that is tried [s]. `stable`: the
/// other bounds of the step [s].
Real slow_enough(const StrainRate& fastest, Real max_strain_step, Real stable);

/// Takes the planned step as far as the tries allow, and returns its outcome.
StepOutcome try_step(WorldState& world, const StepPlan& plan, Tries& tries);

/// Restores data that a try, or a call of advance, overwrites before it is known to be good. Listed here, once:
///
///     data                                      written by             undone by
///     nodes.velocity of held and led nodes      drive_nodes            a copy from the start of the try
///     bodies.max_speed, bodies.frame_speed      check_state            a copy from the start of the try
///     nodes.velocity_next of sleeping bodies    solve_regions          zero, its value as long as they sleep
///     nodes.position, nodes.velocity, time,
///     rigid_bodies.center, rotation, moments
///     and axes                                  drift_to (leapfrog)    a copy from the start of the call
///     elements.implicit_modulus,
///     clusters.inverse                          stiffen_clusters       nothing: they follow the shapes at the start of
///                                                                      the try, as they do at the end of a call; with
///                                                                      leapfrog, whose shapes drift before, a copy
///                                                                      from the start of the call
///     pairs, their search                       find_candidates        nothing: results of a search for the positions
///                                                                      at the start of the step stay valid;
///     search.memory.body_unmeasured                                    bodies that no committed step has measured
///                                                                      are searched again
///
/// All other state is written only by stages that run in a good step, and by commit.
/// tests/scene/transaction_test.cpp compares this list with the writes that the stages declare.
class StepTransaction {
public:
    void begin_try(const Model& model);
    void roll_back_try(Model& model) const;
    /// Marks by body: asleep when the try began. Valid until `rested` is called.
    std::span<const std::uint8_t> asleep_before() const { return asleep_; }
    /// Marks by body: took no part in the try or in its end, since it was asleep when the try began or is asleep now.
    std::span<const std::uint8_t> rested(const BodyTable& bodies);

    /// Both do nothing unless the integrator is leapfrog, which alone drifts before its first kick.
    void begin_call(const Model& model, const Clock& clock);
    void roll_back_call(Model& model, Clock& clock) const;

private:
    Column<std::uint8_t> asleep_;           // bodies.asleep
    Column<Real> max_speed_, frame_speed_;  // bodies.max_speed, bodies.frame_speed [m/s]
    Column<Vec3> driven_velocity_;          // velocities of attachments.node [m/s]
    Real time_ = 0;                         // start of the call [s]
    Column<Vec3> position_, velocity_;      // all nodes [m, m/s]
    Column<Vec3> center_;                   // rigid bodies [m]
    Column<Vec3> moments_;                  // rigid bodies [kg m^2]
    Column<Mat3> rotation_, axes_;          // rigid bodies
    Column<Vec3> displacement_;             // implicit bodies [m]
    Column<ElementLane> modulus_;           // elements.implicit_modulus [Pa]
    Column<Real> inverse_;                  // clusters.inverse [1/kg]
};

}  // namespace skerry
