// What the stages of one step hand to each other, and the memory they work in. Nothing here outlives the step, but for
// contacts and regions, which can be looked at until the next one, and what a guess of the solver's cost is based on.
#pragma once

#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/joint_table.h"
#include "components/region_table.h"
#include "skerry/settings.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/contact/keep_resting_contacts.h"
#include "systems/contact/measure_contacts.h"
#include "systems/contact/separate_regions.h"
#include "systems/contact/sum_contact_impulses.h"
#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/checks/find_inversions.h"
#include "systems/dynamics/checks/measure_reactions.h"
#include "systems/dynamics/checks/measure_work.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/joints/measure_joints.h"
#include "systems/dynamics/motion/update_sleep.h"
#include "systems/dynamics/stability/watch_stable_steps.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// What a step is asked to be. Written before its stages start; none of them writes it.
struct StepParameters {
    Real h = 0;     // s, for which positions move
    Real kick = 0;  // s, for which forces act: from the time of the velocities before the step to that of those after
    // kick over that of the step before, of which elements still know what relaxed; 0: they do not
    Real kick_over_last = 0;
    Real longest = 0;             // s, that the next step may be at most, as far as is known
    Real lag = 0;                 // s, by which velocities are behind positions at the kick
    Vec3 gravity = Vec3::Zero();  // m/s^2
    ContactRegions contact_regions = ContactRegions::separate;
    CollisionSettings collision;
    SolverSettings solver;
    Real max_strain_step = 0;
    Real theta = 1;
    LongStepTimes long_step;
    bool takes_long_steps = false;  // implicit bodies may
    SleepSettings sleep;
    bool let_invert = false;           // the last of the tries to avoid it
    bool forces_known = false;         // the try before this one left them: of the same step, and as long
    bool problem_wanted = false;       // somebody wants to see the contact problem of this step
    bool forces_wanted = false;        // somebody wants to know what contacts and attachments give
    Vec3 moment_point = Vec3::Zero();  // m, that their moments are about
    bool draws_late = false;           // what only draws round bodies is placed when somebody looks at it
};

/// What the stages find.
struct StepFindings {
    StepVerdict verdict;
    Inversions inversions;
    Index crossings = 0;  // features that would go through each other: not zero, and the step is tried again
    ContactMeasures measures;
    ExternalWork external;
    TakenByRest rest;
    JointMeasures joints;
    Index unstrained = 0;  // bodies whose elements do nothing in this step
    Real relaxed = 0;      // J, taken out by what relaxes in the elements in this step
    Real viscous = 0;      // J, by the viscosity of implicit elements in this step
    Real damped = 0;       // J, taken out by damping in this step
    // J, brought in by clusters that follow what has stiffened before this try
    Real stiffened = 0;
    StrainFindings strained;  // by the implicit steps of bodies
};

inline bool inverts(const Inversions& inversions, const StepParameters& parameters) {
    return inversions.first && !parameters.let_invert;
}
/// Whether a step can be committed.
inline bool can_be_taken(const StepVerdict& verdict, Index crossings, const Inversions& inversions,
                         const StepParameters& parameters) {
    return verdict.fault == StepFault::none && crossings == 0 && !inverts(inversions, parameters);
}

/// Node velocities that a step overwrites and its contact problem is made of.
struct KeptVelocities {
    Column<Vec3> velocity;          // m/s, at the start of the step
    Column<Vec3> velocity_next;     // m/s, predicted
    Column<Vec3> position, center;  // m, of nodes and of rigid bodies, at the start of the step; where any is rigid
    Column<Mat3> rotation;          // of rigid bodies, at the start of the step
    Column<Vec3> angular_momentum;  // kg m^2/s, the same
    Column<Vec3> deforming, deforming_before;  // m/s, of implicit bodies: kicked, at the start of the step
};

/// What contacts and attachments give in one step.
struct ForceScratch {
    Column<PairSums> pairs;              // of sum_contact_impulses
    Column<Vec3> held_impulse;           // N s, by node, the same
    Column<Vec3> node_impulse;           // of measure_reactions
    Column<ImpulseAndMoment> reactions;  // by attachment, the same
    Column<Vec3> held_velocity;          // m/s, by node: of held nodes, after the step before
};

/// What the settings ask of the contact solver, whose defaults are theirs.
SolverSettings solver_settings(const Settings& settings);

/// What the settings ask of every step.
StepParameters step_parameters(const Settings& settings);

struct StepScratch {
    StepParameters parameters;
    StepFindings findings;
    ContactTable contacts;
    JointBlockTable joints;
    RegionTable regions;
    Real awake_mass = 0;      // kg, at the start of the step
    bool ran_inline = false;  // on the calling thread alone
    bool left_out = false;    // no stage ran, since nothing moves

    SeparationMemory separation_memory;
    SolverMemory solver_memory;
    SleepMemory sleep_memory;
    KeptVelocities kept_velocities;
    ForceScratch forces;
    Column<Real> stiffness_sum;        // of stable_step, by node
    Column<std::uint8_t> beside_fast;  // of check_state, by node
    Column<Vec3> cluster_kick;         // of kick_clusters
    Column<Real> cluster_work;         // of kick_clusters
    ImplicitCoupling coupling;         // of couple_implicit_bodies
    Column<StrainPart> strain_parts;   // of strain_implicit_bodies
    Column<std::uint8_t> pressed;      // by body at rest, in this step
    Column<ExternalWork> work_parts;   // of measure_work
    InversionMemory inversions;        // of find_inversions
    Column<WatchPart> watch_parts;     // of watch_stable_steps
    Column<WatchPieces> watch_pieces;  // of keep_shapes
    Column<Real> viscous_parts;        // of measure_viscosity
    RestingMemory resting_memory;      // of keep_resting_contacts

    bool inverts() const { return skerry::inverts(findings.inversions, parameters); }
    bool taken() const { return can_be_taken(findings.verdict, findings.crossings, findings.inversions, parameters); }
};

}  // namespace skerry
