// Data that the stages of one step pass to each other, and working memory of the stages. Most of these data are not
// used after the step. Exceptions: users can read contacts and regions until the next step, `solver_memory` keeps
// estimates of the cost of the solver, and the next step reads ForceScratch::held_velocity.
#pragma once

#include "components/cable_table.h"
#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/joint_table.h"
#include "components/region_table.h"
#include "components/tie_table.h"
#include "engine/world/ranks/regions/rank_regions.h"
#include "engine/world/tuning.h"
#include "skerry/report.h"
#include "skerry/settings.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/contact/keep_resting_contacts.h"
#include "systems/contact/measure_contacts.h"
#include "systems/contact/measure_ties.h"
#include "systems/contact/prepare_ties.h"
#include "systems/contact/separate_regions.h"
#include "systems/contact/sum_contact_impulses.h"
#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/checks/find_inversions.h"
#include "systems/dynamics/checks/measure_reactions.h"
#include "systems/dynamics/checks/measure_work.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/joints/measure_joints.h"
#include "systems/dynamics/motion/hold_axes.h"
#include "systems/dynamics/motion/update_sleep.h"
#include "systems/dynamics/stability/watch_stable_steps.h"
#include "systems/forces/add_loads.h"
#include "systems/forces/prepare_cables.h"
#include "systems/forces/springs.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// Inputs of a step. They are set before its stages start, and no stage writes them.
struct StepParameters {
    Real h = 0;          // step length: time by which positions move [s]
    Real kick_time = 0;  // time for which forces act on velocities in this step [s]
    Real longest = 0;    // estimated upper bound of the length of the next step [s]
    Real lag = 0;        // time by which velocities are older than positions when the kick begins [s]
    // time by which velocities are older than positions between steps: `lag`, or 0 with leapfrog [s]
    Real work_lag = 0;
    ForceIntervals intervals;     // time intervals in which forces act in this step
    Vec3 gravity = Vec3::Zero();  // m/s^2
    ContactRegions contact_regions = ContactRegions::separate;
    CollisionSettings collision;
    SolverSettings solver;
    Real max_strain_step = 0;
    Real theta = 1;
    LongStepTimes long_step;
    bool takes_long_steps = false;  // true if implicit bodies may take long steps
    SleepSettings sleep;
    bool let_invert = false;  // true if elements may turn inside out in this attempt at the step
    // True if the elastic forces of the previous attempt at this step are still valid, because both attempts have the
    // same length.
    bool forces_known = false;
    bool problem_wanted = false;       // true if a user requested the contact problem of this step
    bool forces_wanted = false;        // true if a user requested forces of contacts and attachments
    Vec3 moment_point = Vec3::Zero();  // reference point of the moments that a user requested [m]
    bool draws_late = false;           // true: nodes that only draw round bodies are updated later, on demand
};

/// Results of the stages of a step.
struct StepFindings {
    StepVerdict verdict;
    Inversions inversions;
    Index crossings = 0;  // number of crossings found in this attempt; if nonzero, the step is repeated
    ContactMeasures measures;
    ExternalWork external;
    // Impulse and work of holding nodes along single directions: by hold_axes (before contacts), by rows of the contact
    // problem, and by hold_axes_again (after its solution).
    ExternalWork held, held_rows, held_again;
    SleepLosses rest;
    JointMeasures joints;
    TieMeasures ties;
    SpringWork springs;
    Real fibre_work = 0;     // work of the passive stress of fibres on the nodes [J]
    Real cavity_work = 0;    // work of gases and liquids in cavities on the nodes [J]
    Real cavity_supply = 0;  // energy that gases and liquids have gained because their amounts have changed [J]
    CableMeasures cables;
    Index released_ties = 0;  // number of ties whose last node has broken off in this step
    Index unstrained = 0;     // number of bodies whose elements are skipped, because they are undeformed in free flight
    Real plastic = 0;         // energy dissipated by plastic flow at the end of this step [J]
    Real relaxed = 0;         // energy dissipated by relaxation of the elements in this step [J]
    Real viscous = 0;         // energy dissipated by the viscosity of implicit elements in this step [J]
    Real damped = 0;          // energy dissipated by damping in this step [J]
    // Energy that the clusters have gained at the start of this attempt, because their matrices were updated for
    // stiffened elements [J].
    Real stiffened = 0;
    StrainFindings strained;  // results of the deformation of implicit bodies
};

inline bool inverts(const Inversions& inversions, const StepParameters& parameters) {
    return inversions.first && !parameters.let_invert;
}
/// True if the attempt has found no reason against committing the step.
inline bool can_be_taken(const StepVerdict& verdict, Index crossings, const Inversions& inversions,
                         const StepParameters& parameters) {
    return verdict.fault == StepFault::none && crossings == 0 && !inverts(inversions, parameters);
}

/// Copy of the state at the start of a step, from which its contact problem is exported. The step overwrites the
/// original.
struct KeptVelocities {
    Column<Vec3> velocity;       // node velocities at the start of the step [m/s]
    Column<Vec3> velocity_next;  // node velocities at the end of the step as predicted without contacts [m/s]
    // Positions of nodes, and centres of mass of rigid and implicit bodies, at the start of the step [m]. These two
    // columns and the following ones are stored only if there are rigid or implicit bodies.
    Column<Vec3> position, center;
    // `rotation` and `axes` of rigid and implicit bodies at the start of the step (RigidBodyTable). At large strain the
    // axes of an implicit body change in the step.
    Column<Mat3> rotation, axes;
    Column<Vec3> angular_momentum;  // of rigid and implicit bodies at the start of the step [kg m^2/s]
    // Deformation velocities of implicit bodies [m/s]: after the kick (before contacts are solved), and at the start of
    // the step.
    Column<Vec3> deforming, deforming_before;
};

/// Impulses of contacts and attachments in one step.
struct ForceScratch {
    Column<PairSums> pairs;              // by pair with contacts: sums of impulses; result of sum_contact_impulses
    Column<Vec3> held_impulse;           // by node: contact impulse on a held node (sum_contact_impulses) [N s]
    Column<Vec3> node_impulse;           // by node: working memory of measure_reactions [N s]
    Column<ImpulseAndMoment> reactions;  // impulse and moment of each attachment; result of measure_reactions
    Column<Vec3> held_velocity;          // by node: velocity of a held node after the previous step [m/s]
};

/// Returns the settings of the contact solver, taken from `settings` and `tuning`.
SolverSettings solver_settings(const Settings& settings, const Tuning& tuning);

/// Returns the step parameters that follow from the settings alone.
StepParameters step_parameters(const Settings& settings, const Tuning& tuning);

struct StepScratch {
    StepParameters parameters;
    StepFindings findings;
    ContactTable contacts;
    JointBlockTable joints;
    TieRowTable ties;
    CableBlockTable cables;
    RegionTable regions;
    RankRegions rank_regions;  // empty if this process simulates the whole world
    RunCounters counters;      // counters of the last committed step alone (count_step)
    Real awake_mass = 0;       // mass of bodies, except ghosts, that are awake at the start of the step [kg]
    bool ran_inline = false;   // true if all stages ran on the calling thread
    bool skipped = false;      // true if no stage ran in this step, because nothing moves (nothing_moves)

    SeparationMemory separation_memory;
    SolverMemory solver_memory;
    SleepMemory sleep_memory;
    KeptVelocities kept_velocities;
    ForceScratch forces;
    HeldRows held_rows;
    Column<Vec3> axis_impulse;   // by entry of AttachmentTable::node: impulse along single held directions [N s]
    Column<Real> stiffness_sum;  // by node: sum of the stiffnesses of its elements (stable_step.h); working memory
    Column<std::uint8_t> beside_fast;  // one entry per node; working memory of check_state
    Column<Vec3> cluster_kick;         // by item of clusters.nodes: impulse of the forces of this step [N s]
    Column<Real> cluster_work;         // used by kick_clusters
    ImplicitCoupling coupling;         // used by couple_implicit_bodies
    Column<StrainPart> strain_parts;   // used by strain_implicit_bodies
    // by body: nonzero if a stored contact impulse acts on it (mark_pressed), or another rank wakes it
    Column<std::uint8_t> pressed;
    Column<ExternalWork> work_parts;  // used by measure_work
    InversionMemory inversions;       // used by find_inversions
    Column<WatchPart> watch_parts;    // used by watch_stable_steps
    Column<Real> viscous_parts;       // used by measure_viscosity
    Column<Real> plastic_parts;       // used by yield_elements
    // For each body, nonzero if a load, spring, cable, cavity, fibre, motor or tie that acts on it changes in this
    // step. Empty if there are none of these, or bodies cannot fall asleep.
    Column<std::uint8_t> driven;
    Column<BodyField> fields;            // used by add_loads
    RestingMemory resting_memory;        // used by keep_resting_contacts
    Column<Index> self_crossing_places;  // used by find_self_crossings

    bool inverts() const { return skerry::inverts(findings.inversions, parameters); }
    bool taken() const { return can_be_taken(findings.verdict, findings.crossings, findings.inversions, parameters); }
};

}  // namespace skerry
