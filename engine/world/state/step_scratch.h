// Data that the stages of one step pass to each other, and working memory of the stages. These data are not used after
// the step, except for
// - contacts and regions, which users can read until the next step,
// - `solver_memory` (estimates of solver cost) and ForceScratch::held_velocity, which the next step uses.
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
    // Estimated upper bound of the length of the next step. check_state finds elements that deform too fast for a step
    // of this length [s].
    Real longest = 0;
    Real lag = 0;  // time by which velocities are older than positions when forces begin to act in this step [s]
    // time by which velocities are older than positions when work is measured: `lag`, or 0 with leapfrog [s]
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
    // True if the elastic forces of the previous attempt are still valid, because it was an attempt at the same step
    // with the same length.
    bool forces_known = false;
    bool problem_wanted = false;       // true if a user requested the contact problem of this step
    bool forces_wanted = false;        // true if a user requested forces of contacts and attachments
    Vec3 moment_point = Vec3::Zero();  // reference point of the moments that a user requested [m]
    // true: nodes that are only drawn (those of round bodies) are updated later, on demand
    bool draws_late = false;
};

/// Results of the stages of a step.
struct StepFindings {
    StepVerdict verdict;
    Inversions inversions;
    Index crossings = 0;  // number of crossings found in this attempt; if nonzero, the step is repeated
    ContactMeasures measures;
    ExternalWork external;
    // Impulse and work of attachments that hold nodes along single directions. `held`: by hold_axes, before contacts
    // are solved. `held_rows`: by rows of the contact problem. `held_again`: by hold_axes_again, after contacts are
    // solved.
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
    // number of bodies whose elements this step skips, because the bodies are undeformed (find_unstrained)
    Index unstrained = 0;
    Real plastic = 0;  // energy dissipated by plastic flow at the end of this step [J]
    Real relaxed = 0;  // energy dissipated by relaxation of the elements in this step [J]
    Real viscous = 0;  // energy dissipated by the viscosity of implicit elements in this step [J]
    Real damped = 0;   // energy dissipated by damping in this step [J]
    // Kinetic energy that clusters (groups of nodes that implicit elements couple) gained at the start of this attempt,
    // because elements stiffened and so increased the inertia in the cluster matrices [J].
    Real stiffened = 0;
    StrainFindings strained;  // impulse, losses and Newton iterations of the deformation of implicit bodies
};

inline bool inverts(const Inversions& inversions, const StepParameters& parameters) {
    return inversions.is_first_of_body && !parameters.let_invert;
}
/// True if the step can be committed: the attempt has found no fault, no crossing, and no inversion that must be
/// avoided.
inline bool can_be_taken(const StepVerdict& verdict, Index crossings, const Inversions& inversions,
                         const StepParameters& parameters) {
    return verdict.fault == StepFault::none && crossings == 0 && !inverts(inversions, parameters);
}

/// Copy of the velocities and poses that a step overwrites. The contact problem of the step is exported from this copy
/// after the step.
struct KeptVelocities {
    Column<Vec3> velocity;       // node velocities at the start of the step [m/s]
    Column<Vec3> velocity_next;  // node velocities at the end of the step as predicted without contacts [m/s]
    // Positions of nodes, and centres of mass of rigid and implicit bodies, at the start of the step [m]. All columns
    // from here on are empty if there are no rigid or implicit bodies.
    Column<Vec3> position, center;
    // RigidBodyTable::rotation and axes at the start of the step. `axes`: principal axes of inertia, which change in a
    // step if an implicit body has a large strain.
    Column<Mat3> rotation, axes;
    Column<Vec3> angular_momentum;  // angular momentum of rigid and implicit bodies at the start of the step [kg m^2/s]
    // Deformation velocities of implicit bodies (ImplicitNodeTable::velocity) [m/s]. `deforming`: after all forces but
    // contacts have acted. `deforming_before`: at the start of the step.
    Column<Vec3> deforming, deforming_before;
};

/// Impulses of contacts and attachments in one step.
struct ForceScratch {
    // one entry for each pair in contact: sums of its impulses (sum_contact_impulses)
    Column<PairSums> pairs;
    // for each node: contact impulse if the node is held (sum_contact_impulses) [N s]
    Column<Vec3> held_impulse;
    Column<Vec3> node_impulse;           // for each node: working memory of measure_reactions [N s]
    Column<ImpulseAndMoment> reactions;  // impulse of each attachment and its moment (measure_reactions)
    Column<Vec3> held_velocity;          // for each node: velocity after the previous step if the node is held [m/s]
};

/// Returns the settings of the contact solver, taken from `settings` and `tuning`.
SolverSettings solver_settings(const Settings& settings, const Tuning& tuning);

/// Returns the step parameters that follow from the settings alone. All other parameters keep their default values.
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
    RunCounters counters;      // counters of the last committed step, not of the run (count_step)
    Real awake_mass = 0;       // mass of bodies, except ghosts, that are awake at the start of the step [kg]
    bool ran_inline = false;   // true if all stages of the last attempt ran on the calling thread
    bool skipped = false;      // true if no stage ran in the last attempt, because nothing moves (nothing_moves)

    SeparationMemory separation_memory;
    SolverMemory solver_memory;
    SleepMemory sleep_memory;
    KeptVelocities kept_velocities;
    ForceScratch forces;
    HeldRows held_rows;
    Column<Vec3> axis_impulse;  // for each entry of AttachmentTable::node: impulse along the held directions [N s]
    // for each node: sum of the stiffnesses of its elements (stable_step.h); working memory
    Column<Real> stiffness_sum;
    Column<std::uint8_t> beside_fast;  // one entry per node; working memory of check_state
    // for each item of clusters.nodes: impulse of the forces of this step on the node [N s]
    Column<Vec3> cluster_kick;
    Column<Real> cluster_work;        // used by kick_clusters
    ImplicitCoupling coupling;        // used by couple_implicit_bodies
    Column<StrainPart> strain_parts;  // used by strain_implicit_bodies
    // For each body: nonzero if the body must be awake. Either a contact impulse that was stored in an earlier step
    // acts on it (mark_pressed), or another rank wakes it.
    Column<std::uint8_t> pressed;
    Column<ExternalWork> work_parts;  // used by measure_work
    InversionMemory inversions;       // used by find_inversions
    Column<WatchPart> watch_parts;    // used by watch_stable_steps
    Column<Real> viscous_parts;       // used by measure_viscosity
    Column<Real> plastic_parts;       // used by yield_elements
    // For each body: nonzero if it must stay awake, because a load, spring, cable, cavity, fibre, motor or tie that
    // acts on it changes in this step. Empty if there are none of these, or bodies cannot fall asleep.
    Column<std::uint8_t> driven;
    Column<BodyField> fields;            // used by add_loads
    RestingMemory resting_memory;        // used by keep_resting_contacts
    Column<Index> self_crossing_places;  // used by find_self_crossings

    bool inverts() const { return skerry::inverts(findings.inversions, parameters); }
    bool taken() const { return can_be_taken(findings.verdict, findings.crossings, findings.inversions, parameters); }
};

}  // namespace skerry
