// Reports of a step and of a run.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/handle.h"
#include "components/options.h"
#include "components/types.h"
#include "skerry/settings.h"

#pragma GCC visibility push(default)
namespace skerry {

enum class StepStatus { ok, not_finite, too_fast, too_far, too_stiff, unsolved, stopped };
enum class ContactMotion { open, stick, slide };
/// The reason why a step is not longer (docs/step_length.md). Speed is measured before a step. Inversions, crossings
/// and sudden impacts are found in tries that are given up; after these the length grows by a fifth from step to step.
/// - setting: step_size.
/// - rest: the stable step of a body in its shape at rest.
/// - strain: the stable step of a deformed body, or an implicit body of large strain for which Newton's method fails at
///   longer steps.
/// - speed: the deformation gradient of an element would change by more than 0.2 in a step (Frobenius norm).
/// - inversion: an element would turn inside out.
/// - crossing: surfaces would cross.
enum class StepLimit { setting, rest, strain, speed, inversion, crossing };

template <>
struct EnumNames<StepLimit> {
    static constexpr std::array<std::pair<StepLimit, std::string_view>, 6> table{{
        {StepLimit::setting, "setting"},
        {StepLimit::rest, "rest"},
        {StepLimit::strain, "strain"},
        {StepLimit::speed, "speed"},
        {StepLimit::inversion, "inversion"},
        {StepLimit::crossing, "crossing"},
    }};
};

/// One contact of the last step, or a contact between bodies at rest. The latter is as in the last step before the
/// rest, with the impulse of the same force in a step as long as the last one.
struct Contact {
    // the body of the point or of the first edge; a stale handle if that belongs to a mesh collider
    BodyHandle first{};
    BodyHandle second{};        // the other body; a stale handle if that is a collider
    ColliderHandle collider{};  // the collider; a stale handle if there is none
    // local node numbers: node[a] belongs to `first` if weight[a] > 0, to `second` if < 0; it is -1 if weight[a] is 0
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
    Vec3 point = Vec3::Zero();   // on the second body or the collider [m]
    Vec3 normal = Vec3::Zero();  // unit, towards the first body
    Real distance = 0;           // between the surfaces [m]; < 0: they overlap
    // distance that may still close [m]: `distance` less the contact distance, or slightly more at nearly flat edges
    Real gap = 0;
    Vec3 slip = Vec3::Zero();     // tangential relative velocity after the step [m/s]
    Vec3 impulse = Vec3::Zero();  // on the first body [N s]
    // Time for which loads act in the step of the impulse [s]: from the middle of the previous step to the middle of
    // this one. It is the step itself if both have one length, with leapfrog, and for contacts of implicit bodies
    // alone.
    Real seconds = 0;
    ContactMotion motion = ContactMotion::open;
    Index region = -1;  // -1 if none of its nodes moves, and between bodies at rest

    /// Force on the first body [N]. The forces on a body at rest balance its weight and loads, whatever the steps.
    Vec3 force() const { return seconds > 0 ? Vec3(impulse / seconds) : Vec3(Vec3::Zero()); }
};

/// Time and number of runs of one stage.
struct StageReport {
    std::string name;    // folder/stage
    double seconds = 0;  // elapsed time of its runs [s]
    std::uint64_t runs = 0;
    std::uint64_t skipped = 0;
};

struct Energy {
    Real kinetic = 0;     // [J]
    Real elastic = 0;     // [J]
    Real potential = 0;   // of weight, relative to the origin [J]
    Real dissipated = 0;  // by contacts, damping and losses since the start [J]
};

/// Report of a call of `advance`. It is cheap: no allocation unless something went wrong.
class StepReport {
public:
    /// False if a step could not be committed or the call was asked to stop.
    bool ok() const { return status == StepStatus::ok; }
    /// Empty if ok; else the body and the reason.
    std::string message() const;

    /// Names the body that is unstable at step_size of the settings, with the longest step that it allowed, and the
    /// first element that turned inside out. Empty if there is neither.
    std::string warning() const;

    StepStatus status = StepStatus::ok;
    BodyHandle body;     // the body that caused the failure, if not ok
    Index node = -1;     // local number of the node, if one caused the failure
    Index element = -1;  // local number of the element, if one did; `node` is a corner of it
    // too_fast: norm of the change of F of the element; too_far: rounding of positions over mean edge; too_stiff:
    // stable step [s]
    Real value = 0;
    Real step_size = 0;  // length of the last step [s]
    int steps = 0;       // committed steps
    // tries repeated with a shorter step because a body was too fast, surfaces crossed, an element turned inside out,
    // or Newton's method failed
    int shortened = 0;
    // tries repeated with the crossings as contacts, because surfaces crossed
    int retried = 0;
    int limited = 0;             // steps shorter than step_size, at which the body `limited_by` is unstable
    Real limited_step = 0;       // longest step that this body allowed [s]
    std::string limited_by;      // name of the body
    Index contacts = 0;          // of the last step, without those between bodies at rest
    Index regions = 0;           // of the last step
    Index largest_region = 0;    // contacts of the largest region of the last step
    Index unconverged = 0;       // unconverged regions, summed over the steps
    Real worst_error = 0;        // largest relative error of a region over the steps
    Index worst_region = 0;      // number of contacts of this region
    Real max_penetration = 0;    // largest overlap of surfaces over the steps [m]
    Real max_gap_violation = 0;  // largest penetration of the contact shell over the steps [m]
    Index inverted = 0;          // elements that turned inside out, even in shorter tries
    BodyHandle inverted_body{};  // body of the first of them
    std::string inverted_name;
    Index inverted_element = -1;  // number of the first of them in the mesh of the body
    Index crossed = 0;            // features that went through each other because no try could prevent it
    std::string body_name;        // name of `body`, if not ok
};

/// The steps since the world was made that one cause kept from being longer.
struct StepLimitReport {
    StepLimit limit = StepLimit::rest;
    BodyHandle body{};      // a stale handle if the cause is no body: a setting, a crossing
    std::string body_name;  // name at that time
    std::uint64_t steps = 0;
    std::uint64_t tries = 0;  // tries given up for this cause
    Real seconds = 0;         // simulated time of these steps [s]
};

/// The reason why BodyDynamics::automatic made a body explicit or implicit.
/// - given: there was no choice; the caller gave the kind.
/// - self_contact: explicit, since implicit bodies have no self-contact.
/// - strain: explicit, since the body may deform by more than the limit for implicit bodies.
/// - cost: by the predicted costs; implicit if they are less than half of the explicit ones.
enum class DynamicsReason : std::uint8_t { given, self_contact, strain, cost };
template <>
struct EnumNames<DynamicsReason> {
    static constexpr std::array<std::pair<DynamicsReason, std::string_view>, 4> table{{
        {DynamicsReason::given, "given"},
        {DynamicsReason::self_contact, "self_contact"},
        {DynamicsReason::strain, "strain"},
        {DynamicsReason::cost, "cost"},
    }};
};

/// The estimate behind the choice of BodyDynamics::automatic (docs/methods/implicit_bodies.md 6).
struct DynamicsEstimate {
    DynamicsReason reason = DynamicsReason::given;
    Real explicit_step = 0;   // step of the world with the body explicit [s]
    Real implicit_step = 0;   // step of the world with the body implicit [s]
    Real deforming_step = 0;  // step of its deformation then: the larger of implicit_step here and in Settings [s]
    // time of one core per simulated second, for the elements of the world and the solves for this body [s]
    Real explicit_cost = 0, implicit_cost = 0;
    Real strain = 0;  // largest strain that weight, its speed and a fall of ten times its own size may cause
    // frequency above which implicit steps of this length damp vibrations instead of resolving them: omega h > 1/2 [Hz]
    Real damped_above = 0;
};

struct DynamicsChoice {
    BodyHandle body{};
    std::string name;
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;  // the chosen kind
    DynamicsEstimate estimate{};

    /// "implicit: 0.8 s of a core a simulated second, in steps of 0.00833 s; explicit 9 s of a core a simulated second,
    /// in steps of 1.4e-05 s; what vibrates faster than 9.5 Hz is damped"
    std::string message() const;
};

/// Two bodies, or a body and a collider, that overlapped before the first step after one of them was added or put
/// elsewhere. Surfaces that only touch, or are closer than the contact distance, do not overlap.
struct StartOverlap {
    BodyHandle first{};
    BodyHandle second{};                  // the other body; a stale handle if that is a collider
    ColliderHandle collider{};            // the collider; a stale handle if there is none
    std::string first_name, second_name;  // names at that time
    OverlapKind kind = OverlapKind::crossing;
    Real depth = 0;                 // length of a translation of `first` that ends the overlap, about the shortest [m]
    Vec3 direction = Vec3::Zero();  // of that translation, unit
    Vec3 place = Vec3::Zero();      // centre of the common volume [m]
    bool resolved = false;          // true if the two were moved apart

    /// "bodies 'a' and 'b' overlap by 0.02 m at (0, 0, 0.1) m"
    std::string message() const;
};

/// A body that was moved as a whole before its first step, so that it overlaps nothing.
struct StartMove {
    BodyHandle body{};
    std::string name;
    Vec3 translation = Vec3::Zero();  // [m]
};

/// Sums and maxima over all steps since the world was made.
struct RunCounters {
    std::uint64_t steps = 0;
    std::uint64_t inline_steps = 0;   // steps too small for several threads to pay
    std::uint64_t resting_steps = 0;  // steps in which all bodies rest and nothing moves; no stage runs
    std::uint64_t unstrained = 0;     // freely flying bodies of all steps whose elements are skipped
    std::uint64_t shortened = 0;      // tries repeated with a shorter step
    std::uint64_t retried = 0;        // tries repeated with the crossings as contacts
    std::uint64_t limited = 0;        // steps shorter than step_size, at which a body is unstable
    std::uint64_t inversions = 0;     // elements that turned inside out, counted each time
    std::uint64_t contact_sum = 0, iteration_sum = 0;     // contacts, and sweeps of regions
    std::uint64_t solved = 0;                             // all regions
    std::uint64_t unconverged = 0;                        // regions that reached the iteration limit
    std::uint64_t certified = 0;                          // regions whose warm start needed no sweep
    std::uint64_t closed_form = 0;                        // regions of one contact
    std::uint64_t separating = 0;                         // regions whose contacts all separate
    std::uint64_t frictionless = 0;                       // regions without friction, solved with one row per contact
    std::uint64_t in_lanes = 0;                           // regions solved side by side in vector lanes
    std::uint64_t contact_steps = 0;                      // contacts times sweeps, over regions that needed sweeps
    std::uint64_t swept = 0;                              // regions that needed sweeps
    std::uint64_t large_strain_steps = 0;                 // steps of implicit bodies of large strain
    std::uint64_t newton_steps = 0, tangent_factors = 0;  // Newton steps and factorisations of these
    Index max_contacts = 0, max_regions = 0, largest_region = 0;
    Real worst_error = 0;
    Index worst_region = 0;                               // number of contacts of the region with worst_error
    Real dissipated = 0;                                  // by contacts, damping and losses [J]
    Real max_penetration = 0, max_gap_violation = 0;      // see StepReport [m]
    Real start_penetration = 0, start_gap_violation = 0;  // their values in the first step [m]
};

/// The sums of a run and measures of the present state. These take a pass over all tables; the run keeps only the sums.
struct WorldReport : RunCounters {
    Real time = 0;           // [s]
    std::size_t asleep = 0;  // bodies at rest now
    std::size_t bodies = 0, colliders = 0, nodes = 0, elements = 0;
    Real stable_step = 0;          // of the stiffest body now; if no body limits the step, the step taken [s]
    std::string stable_step_body;  // name of this body; empty if no body limits the step
    // Groups of nodes coupled by implicit elements, so that these do not shorten the step (docs/methods/clusters.md).
    std::size_t clusters = 0, cluster_nodes = 0, implicit_elements = 0;
    std::size_t guards = 0;  // tetrahedra in clusters with an inversion barrier (docs/methods/elasticity.md 7.7)
    std::vector<DynamicsChoice> dynamics_choices;  // of bodies added as `automatic`, in the order added
    // Results of the last check for overlaps, before the first step after something was added or put elsewhere.
    std::vector<StartOverlap> start_overlaps;
    std::vector<StartMove> start_moves;
    std::vector<StepLimitReport> step_limits;                             // by number of steps, the largest first
    std::vector<StageReport> stages;                                      // in the order of the step
    double mean_contacts = 0, mean_regions = 0, mean_iterations = 0;      // per step; sweeps per solved region
    std::uint64_t broad_searches = 0, pair_searches = 0, candidates = 0;  // `candidates`: in all lists now
    // Fast features whose motion was tested, crossings that were prevented, and crossings that no try could prevent.
    std::uint64_t crossing_tests = 0, crossings_found = 0, crossed = 0;
    Energy energy;
    Vec3 momentum = Vec3::Zero();          // [kg m/s]
    Vec3 angular_momentum = Vec3::Zero();  // about the origin [kg m^2/s]
    // Errors of the balances of energy and momentum: changes that loads, weight, colliders and losses do not explain.
    // The balances are checked every 256 steps, with clusters every 128, and now; the largest error counts. The shares
    // are relative to all energy or momentum that could be exchanged.
    Real energy_error = 0, energy_error_share = 0;  // [J], [1]
    // [kg m/s], [1]; NaN if a held body is damped, or if a held node belongs to an implicit element. Damping, or the
    // inertia of the element, then takes momentum (World::forces reports that of the element).
    Real momentum_error = 0, momentum_error_share = 0;
    std::uint64_t balanced_steps = 0;  // steps since the balances began anew: at the last change from outside
    Real worst_volume_ratio = 1;       // smallest det F of a tetrahedron now; < 0: inverted
    std::string worst_volume_body;
    Index worst_volume_element = -1;  // number of this tetrahedron in the mesh of the body
    Index near_inversion = 0;         // tetrahedra with det F below 0.1
    // Smoothed elements below a fifth of their volume: tetrahedra around an edge can stay folded against each other
    // although none of them is inverted. Then the first body with such elements, and a tetrahedron of its worst
    // element.
    Index folded = 0;
    std::string folded_body;
    Index folded_element = -1;
    Index inverted = 0;  // tetrahedra with det F below 0
    // Rotation of the fastest turning collider in the longest step allowed now [rad]. Contacts assume that its surface
    // moves straight within a step; the error is half the square of this rotation times the arm.
    Real collider_turn = 0;
    std::string turning_collider;
};

}  // namespace skerry
#pragma GCC visibility pop
