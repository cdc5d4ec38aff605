// Data that the stages of one step pass to each other, and their working memory. Nothing here outlives the step, except
// contacts and regions, readable until the next one, and the data for estimates of the solver's cost.
#pragma once

#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/joint_table.h"
#include "components/region_table.h"
#include "engine/world/tuning.h"
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

/// Inputs of a step. Written before its stages start; no stage writes them.
struct StepParameters {
    Real h = 0;     // time by which positions move [s]
    Real kick = 0;  // time for which forces act: from the velocities before the step to those after it [s]
    // `kick` over that of the step before, whose relaxed strain the elements still know; 0: they do not
    Real kick_over_last = 0;
    Real longest = 0;             // upper bound of the next step, as far as known [s]
    Real lag = 0;                 // time by which velocities are behind positions at the kick [s]
    Vec3 gravity = Vec3::Zero();  // m/s^2
    ContactRegions contact_regions = ContactRegions::separate;
    CollisionSettings collision;
    SolverSettings solver;
    Real max_strain_step = 0;
    Real theta = 1;
    LongStepTimes long_step;
    bool takes_long_steps = false;  // implicit bodies may take long steps
    SleepSettings sleep;
    bool let_invert = false;           // elements may turn inside out in this try
    bool forces_known = false;         // the previous try of this step, with the same length, left valid forces
    bool problem_wanted = false;       // the contact problem of this step was requested
    bool forces_wanted = false;        // forces of contacts and attachments were requested
    Vec3 moment_point = Vec3::Zero();  // reference point of their moments [m]
    bool draws_late = false;           // nodes that only draw round bodies are placed on demand
};

/// Results of the stages.
struct StepFindings {
    StepVerdict verdict;
    Inversions inversions;
    Index crossings = 0;  // features that would pass through each other; if not zero, the step is tried again
    ContactMeasures measures;
    ExternalWork external;
    TakenByRest rest;
    JointMeasures joints;
    Index unstrained = 0;  // number of bodies whose elements are skipped in this step
    Real relaxed = 0;      // energy dissipated by relaxation of the elements in this step [J]
    Real viscous = 0;      // energy dissipated by the viscosity of implicit elements in this step [J]
    Real damped = 0;       // energy dissipated by damping in this step [J]
    // energy brought in before this try by clusters that follow stiffened elements [J]
    Real stiffened = 0;
    StrainFindings strained;  // results of the implicit steps of bodies
};

inline bool inverts(const Inversions& inversions, const StepParameters& parameters) {
    return inversions.first && !parameters.let_invert;
}
/// Whether a step can be committed.
inline bool can_be_taken(const StepVerdict& verdict, Index crossings, const Inversions& inversions,
                         const StepParameters& parameters) {
    return verdict.fault == StepFault::none && crossings == 0 && !inverts(inversions, parameters);
}

/// State that a step overwrites and that its contact problem consists of.
struct KeptVelocities {
    Column<Vec3> velocity;          // at the start of the step [m/s]
    Column<Vec3> velocity_next;     // predicted [m/s]
    Column<Vec3> position, center;  // places of nodes and rigid bodies at the start; only if any is rigid [m]
    Column<Mat3> rotation;          // orientation of rigid bodies at the start of the step
    Column<Vec3> angular_momentum;  // of rigid bodies at the start of the step [kg m^2/s]
    Column<Vec3> deforming, deforming_before;  // implicit bodies: after the kick, at the start of the step [m/s]
};

/// Impulses of contacts and attachments in one step.
struct ForceScratch {
    Column<PairSums> pairs;              // from sum_contact_impulses
    Column<Vec3> held_impulse;           // by node, from sum_contact_impulses [N s]
    Column<Vec3> node_impulse;           // from measure_reactions
    Column<ImpulseAndMoment> reactions;  // by attachment, from measure_reactions
    Column<Vec3> held_velocity;          // by node: velocity of held nodes after the previous step [m/s]
};

/// Contact solver settings of a world. Their defaults are those of Settings and Tuning.
SolverSettings solver_settings(const Settings& settings, const Tuning& tuning);

/// Parameters that the settings determine for every step.
StepParameters step_parameters(const Settings& settings, const Tuning& tuning);

struct StepScratch {
    StepParameters parameters;
    StepFindings findings;
    ContactTable contacts;
    JointBlockTable joints;
    RegionTable regions;
    Real awake_mass = 0;      // mass of bodies not asleep at the start of the step [kg]
    bool ran_inline = false;  // the stages ran on the calling thread alone
    bool left_out = false;    // no stage ran, since nothing moves

    SeparationMemory separation_memory;
    SolverMemory solver_memory;
    SleepMemory sleep_memory;
    KeptVelocities kept_velocities;
    ForceScratch forces;
    Column<Real> stiffness_sum;        // by node, used by stable_step
    Column<std::uint8_t> beside_fast;  // by node, used by check_state
    Column<Vec3> cluster_kick;         // used by kick_clusters
    Column<Real> cluster_work;         // used by kick_clusters
    ImplicitCoupling coupling;         // used by couple_implicit_bodies
    Column<StrainPart> strain_parts;   // used by strain_implicit_bodies
    Column<std::uint8_t> pressed;      // marks by body: sleeping bodies pressed by a contact in this step
    Column<ExternalWork> work_parts;   // used by measure_work
    InversionMemory inversions;        // used by find_inversions
    Column<WatchPart> watch_parts;     // used by watch_stable_steps
    Column<WatchPieces> watch_pieces;  // used by keep_shapes
    Column<Real> viscous_parts;        // used by measure_viscosity
    RestingMemory resting_memory;      // used by keep_resting_contacts

    bool inverts() const { return skerry::inverts(findings.inversions, parameters); }
    bool taken() const { return can_be_taken(findings.verdict, findings.crossings, findings.inversions, parameters); }
};

}  // namespace skerry
