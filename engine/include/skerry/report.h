// What a step and a run tell.
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
/// What keeps a step from being longer (docs/step_length.md). setting: step_size. rest: the stable step of a body as it
/// is at rest; strain: that of a body as it is deformed, or one of large strain of an implicit body for which Newton's
/// method finds nothing longer. speed: an element would deform by more than max_strain_step
/// in a step; inversion: an element would turn inside out; crossing: surfaces would cross. Speed
/// is measured before a step; inversions, crossings and sudden impacts are found in tries that are given up, and steps
/// grow back by a fifth each.
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

/// One contact of the last step, or between what rests: then as it was in the last step before that, with the impulse
/// that its force has in a step as long as the last one.
struct Contact {
    // the body of the point, or of the first edge; a stale handle where that is of a mesh collider
    BodyHandle first{};
    BodyHandle second{};        // the other body; a stale handle where that is a collider
    ColliderHandle collider{};  // the collider, or a stale handle
    // local nodes: place a belongs to `first` if weight[a] > 0, to `second` if < 0; -1 with weight 0
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
    Vec3 point = Vec3::Zero();   // m, on the second body or the collider
    Vec3 normal = Vec3::Zero();  // unit, towards the first body
    Real distance = 0;           // m, between the surfaces; < 0: they overlap
    // m, what may still close: distance less the contact distance, or a bit more where edges are nearly flat
    Real gap = 0;
    Vec3 slip = Vec3::Zero();     // m/s, tangential relative velocity after the step
    Vec3 impulse = Vec3::Zero();  // N s, on the first body
    // s, for which loads act in the step that the impulse is of, between half a step before its start and half a step
    // before its end: the step itself, but where its length differs from that of the step before
    Real seconds = 0;
    ContactMotion motion = ContactMotion::open;
    Index region = -1;  // -1: none of its nodes moves, or it is between what rests

    /// N, on the first body: those on a body at rest add up to what its weight and loads are, whatever the steps.
    Vec3 force() const { return seconds > 0 ? Vec3(impulse / seconds) : Vec3(Vec3::Zero()); }
};

/// Seconds and runs of one stage.
struct StageReport {
    std::string name;  // folder/stage
    double seconds = 0;
    std::uint64_t runs = 0;
    std::uint64_t skipped = 0;
};

struct Energy {
    Real kinetic = 0;     // J
    Real elastic = 0;     // J
    Real potential = 0;   // J, of weight, relative to the origin
    Real dissipated = 0;  // J, by contacts, damping and losses, since the start
};

/// What `advance` did. Cheap: no allocation unless something went wrong.
class StepReport {
public:
    /// False where a step could not be committed, and where the call was asked to stop.
    bool ok() const { return status == StepStatus::ok; }
    /// Empty when ok; else the body, the stage and the reason.
    std::string message() const;

    /// Empty unless step_size of the settings was too long: then the body that does not stand it, and the step that it
    /// stands.
    std::string warning() const;

    StepStatus status = StepStatus::ok;
    BodyHandle body;     // to blame, when not ok
    Index node = -1;     // local, when one node is to blame
    Index element = -1;  // local, when one element is: the node is a corner of it
    // too_fast: norm of what F of the element changes by; too_far: rounding of positions over mean edge; too_stiff:
    // stable step, s
    Real value = 0;
    Real step_size = 0;  // s, of the steps taken
    int steps = 0;       // committed
    // tries given up because a body was too fast, surfaces crossed or an element turned inside out; each was repeated
    // at half the length
    int shortened = 0;
    // tries given up because surfaces crossed; each was repeated with the crossings as contacts
    int retried = 0;
    int limited = 0;         // steps that were shorter than step_size of the settings, which limited_by does not stand
    Real limited_step = 0;   // s, what it stands
    std::string limited_by;  // name of the body
    Index contacts = 0;      // of the last step, without those between what rests
    Index regions = 0;
    Index largest_region = 0;    // contacts
    Index unconverged = 0;       // regions, summed over the steps
    Real worst_error = 0;        // largest relative error of a region over the steps
    Index worst_region = 0;      // contacts of the region that had it
    Real max_penetration = 0;    // m, overlap of surfaces, largest over the steps
    Real max_gap_violation = 0;  // m, pressed into the contact shell, largest over the steps
    Index inverted = 0;          // elements that turned inside out, in shorter tries of their step, too
    BodyHandle inverted_body{};  // of the first of them
    std::string inverted_name;
    Index inverted_element = -1;  // in the order of the body's mesh
    Index crossed = 0;            // features that went through each other, since no try could stop them
    std::string body_name;        // when not ok
};

/// Steps that one thing kept from being longer, since the world was made.
struct StepLimitReport {
    StepLimit limit = StepLimit::rest;
    BodyHandle body{};      // stale where no body is to blame: a setting, surfaces that cross
    std::string body_name;  // as it was then
    std::uint64_t steps = 0;
    std::uint64_t tries = 0;  // given up for it
    Real seconds = 0;         // s, simulated in these steps
};

/// Why BodyDynamics::automatic made a body explicit or implicit. given: it did not, somebody said what it is.
/// self_contact: it touches itself, which implicit bodies do not. strain: it may deform by more than they can. cost:
/// what is predicted to cost less.
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

/// What the choice was made by (docs/methods/implicit_bodies.md 6).
struct DynamicsEstimate {
    DynamicsReason reason = DynamicsReason::given;
    Real explicit_step = 0;   // s, that the world takes with the body explicit
    Real implicit_step = 0;   // s, with it implicit
    Real deforming_step = 0;  // s, of what then deforms in it: longer where Settings::implicit_step is
    // s of one core a simulated second, of the elements of the world and of the solves for this body
    Real explicit_cost = 0, implicit_cost = 0;
    Real strain = 0;  // the largest that weight, its speed and a fall of ten times its own size may bring
    // Hz, of vibrations that implicit steps of this length damp rather than follow: omega h above 1/2
    Real damped_above = 0;
};

struct DynamicsChoice {
    BodyHandle body{};
    std::string name;
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;  // what it became
    DynamicsEstimate estimate{};

    /// "implicit, for 0.8 s of a core a simulated second in steps of 8.3 ms; explicit it would take 9 s in steps of 14
    /// us. Vibrations above 9.5 Hz are damped, not followed"
    std::string message() const;
};

/// Two bodies, or a body and a collider, that overlapped before the first step after one of them was added. Surfaces
/// that only touch, or lie within the contact distance, do not.
struct StartOverlap {
    BodyHandle first{};
    BodyHandle second{};                  // the other body; a stale handle where that is a collider
    ColliderHandle collider{};            // the collider, or a stale handle
    std::string first_name, second_name;  // as they were then
    OverlapKind kind = OverlapKind::crossing;
    Real depth = 0;                 // m, a translation of the first that takes it out, about the shortest
    Vec3 direction = Vec3::Zero();  // unit, of that translation
    Vec3 place = Vec3::Zero();      // m, the middle of what both fill
    bool resolved = false;          // they were moved apart

    /// "bodies 'a' and 'b' overlap by 0.02 m at (0, 0, 0.1) m"
    std::string message() const;
};

/// A body that was moved as a whole before it made a step, so that it overlaps nothing.
struct StartMove {
    BodyHandle body{};
    std::string name;
    Vec3 translation = Vec3::Zero();  // m
};

/// Sums, and largest values, over all steps since the world was made. Each step adds to them.
struct RunCounters {
    std::uint64_t steps = 0;
    std::uint64_t inline_steps = 0;   // too small to pay for threads
    std::uint64_t resting_steps = 0;  // all rested and nothing moved, so that no stage had anything to do
    std::uint64_t unstrained = 0;     // bodies of all steps that only flew, so that their elements were left out
    std::uint64_t shortened = 0;      // steps tried again at half the length
    std::uint64_t retried = 0;        // steps tried again with what crossed in them as contacts
    std::uint64_t limited = 0;        // steps shorter than step_size of the settings, which a body does not stand
    std::uint64_t inversions = 0;     // elements that turned inside out, each time that one did
    std::uint64_t contact_sum = 0, iteration_sum = 0;     // contacts, and sweeps of regions, of each step
    std::uint64_t solved = 0;                             // regions
    std::uint64_t unconverged = 0;                        // regions
    std::uint64_t certified = 0;                          // regions whose warm start needed no sweep
    std::uint64_t closed_form = 0;                        // regions of one contact
    std::uint64_t separating = 0;                         // regions whose contacts all came apart
    std::uint64_t frictionless = 0;                       // regions without friction, solved in one row a contact
    std::uint64_t in_lanes = 0;                           // regions solved side by side with others
    std::uint64_t contact_steps = 0;                      // contacts times sweeps, of regions that were swept
    std::uint64_t swept = 0;                              // regions that needed sweeps
    std::uint64_t large_strain_steps = 0;                 // implicit bodies times steps in which their strain was large
    std::uint64_t newton_steps = 0, tangent_factors = 0;  // of those: Newton's method's, and how often it factored
    Index max_contacts = 0, max_regions = 0, largest_region = 0;
    Real worst_error = 0;
    Index worst_region = 0;                               // contacts of the region that had the worst error
    Real dissipated = 0;                                  // J, by contacts, damping and losses
    Real max_penetration = 0, max_gap_violation = 0;      // m
    Real start_penetration = 0, start_gap_violation = 0;  // m, of these, what the first step began with
};

/// The sums, and the state as it is now. Asking walks all tables; the run itself keeps only the sums.
struct WorldReport : RunCounters {
    Real time = 0;
    std::size_t asleep = 0;  // bodies at rest, now
    std::size_t bodies = 0, colliders = 0, nodes = 0, elements = 0;
    Real stable_step = 0;          // s, of the stiffest body, now; where none sets one, the one that is taken
    std::string stable_step_body;  // which body that is; empty where none sets one
    // Groups of nodes that implicit elements couple, so that these do not make the step shorter
    // (docs/methods/clusters.md).
    std::size_t clusters = 0, cluster_nodes = 0, implicit_elements = 0;
    std::size_t guards = 0;  // tetrahedra in these that are kept from turning over (docs/methods/elasticity.md 7.7)
    std::vector<DynamicsChoice> dynamics_choices;  // of bodies that were added as `automatic`, in the order added
    // Of the last look, which is taken before the first step after something was added.
    std::vector<StartOverlap> start_overlaps;
    std::vector<StartMove> start_moves;
    std::vector<StepLimitReport> step_limits;                         // most steps first
    std::vector<StageReport> stages;                                  // in the order of the step
    double mean_contacts = 0, mean_regions = 0, mean_iterations = 0;  // per step; sweeps per solved region
    std::uint64_t broad_searches = 0, pair_searches = 0, candidates = 0;
    // Fast features whose motion was looked at, those that would have crossed, and those that did since no try could
    // stop them.
    std::uint64_t crossing_tests = 0, crossings_found = 0, crossed = 0;
    Energy energy;
    Vec3 momentum = Vec3::Zero();          // kg m/s
    Vec3 angular_momentum = Vec3::Zero();  // kg m^2/s, about the origin
    // How far to trust it. Differences of energy and momentum from what loads, weights, colliders and losses account
    // for, the largest of the looks taken every 256 steps and now; shares of all that there was to be exchanged.
    Real energy_error = 0, energy_error_share = 0;  // J, 1
    // kg m/s, 1; not a number where a body that is damped is held, or by a node of an implicit element: damping, or the
    // inertia of the element, takes momentum then (World::forces tells that of the element)
    Real momentum_error = 0, momentum_error_share = 0;
    std::uint64_t balanced_steps = 0;  // steps since the balance was opened: it is closed by changes from outside
    Real worst_volume_ratio = 1;       // smallest det F now; < 0 is inverted
    std::string worst_volume_body;
    Index worst_volume_element = -1;  // its place in the mesh of that body
    Index near_inversion = 0;         // elements whose det F is below 0.1
    // Smoothed elements below a fifth of their volume: tetrahedra around an edge that have folded against each other
    // can stay so, each of them sound. A body with some, and a tetrahedron of its worst.
    Index folded = 0;
    std::string folded_body;
    Index folded_element = -1;
    Index inverted = 0;  // elements whose det F is below 0
    // rad, of the collider that turns fastest, in a step as long as may be taken now: contacts take its surface to move
    // straight on meanwhile, off by half of the square of that, of its arm
    Real collider_turn = 0;
    std::string turning_collider;
};

}  // namespace skerry
#pragma GCC visibility pop
