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

/// Result of a call of World::advance. All values but `ok` and `stopped` mean that the last step was refused.
enum class StepStatus {
    ok,          // all steps were taken
    not_finite,  // a velocity would be infinite or NaN
    too_fast,    // a body would deform too far in one step, even in 1/1024 of the stable step
    too_far,     // a body is so far from the origin that its positions have too few digits
    too_stiff,   // the stable step is too short to advance the time
    unsolved,    // Newton's method for large strain did not converge
    stopped,     // the caller ended the call between two steps
};
/// Motion of a contact in the last step.
enum class ContactMotion {
    open,   // the objects do not press on each other
    stick,  // the objects press on each other without sliding
    slide,  // the objects press on each other and slide
};
/// The condition that limits the length of a step (docs/step_length.md).
///
/// An attempt at a step is discarded if it shows an inversion, a crossing, a failure of Newton's method, or a sudden
/// impact that deforms an element too fast (counted as `speed`). If it is repeated with a shorter step, later steps
/// become longer only gradually:
/// - by at most a half per step after a sudden impact,
/// - by at most a fifth per step after the other three.
enum class StepLimit {
    setting,  // Settings::step_size
    rest,     // the stable step of a body in its rest shape
    strain,   // deformation shortened the stable step of a body, or Newton's method failed for a longer step
    // A longer step would change the deformation gradient of an element by more than 0.2 (Frobenius norm), or rotate a
    // body with a joint or tie by more than 0.1 rad. This limit is usually known before the step, from the speed of
    // deformation in the previous step.
    speed,
    inversion,  // an element would turn inside out
    crossing,   // surfaces would pass through each other
};

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

/// A contact of the last step, or a contact between sleeping bodies. A contact between sleeping bodies is shown as in
/// the last step before they fell asleep; its impulse is scaled to the present `seconds`, so that force() returns the
/// contact force of that step.
struct Contact {
    // Body with the point, if a point touches a triangle. Body with the first edge, if two edges touch. A stale handle
    // if this point or edge belongs to a mesh collider.
    BodyHandle first{};
    BodyHandle second{};        // the other body; a stale handle if the partner is a collider
    ColliderHandle collider{};  // the collider; a stale handle if both partners are bodies
    // Numbers of the nodes of the touching features, within their bodies. node[a] belongs to `first` if weight[a] > 0
    // and to `second` if weight[a] < 0. node[a] is -1 if weight[a] is 0.
    std::array<Index, 4> node{};
    // Signed weight of each of these nodes in the relative velocity of the contact (docs/methods/contact.md 1.1).
    std::array<Real, 4> weight{};
    Vec3 point = Vec3::Zero();   // contact point on the second body or the collider [m]
    Vec3 normal = Vec3::Zero();  // unit normal, pointing towards the first body
    Real distance = 0;           // distance between the surfaces; negative if they overlap [m]
    // Distance by which the surfaces may still approach [m]: `distance` minus the contact distance. At an edge whose
    // two faces have almost the same normal, it is slightly more (docs/methods/collision.md 4.5).
    Real gap = 0;
    // Friction coefficients of this contact. If they depend on the direction, they apply along `friction_direction`,
    // and `friction_across` is the coefficient of sliding across it.
    Real static_friction = 0, dynamic_friction = 0, friction_across = 0;
    Vec3 friction_direction = Vec3::Zero();  // unit tangent; zero: friction is the same in all directions
    Vec3 slip = Vec3::Zero();                // tangential velocity of the first body relative to the other [m/s]
    Vec3 impulse = Vec3::Zero();             // impulse on the first body [N s]
    // Duration of the forces in this step [s]: the time from the middle of the previous step to the middle of this
    // step. force() divides the impulse by it. It equals the step length if both steps are equally long, if the
    // integrator is leapfrog, or if only implicit bodies (and colliders) touch.
    Real seconds = 0;
    ContactMotion motion = ContactMotion::open;  // motion after the step
    // Number of the region of the contact: a group of contacts that share moving nodes or bodies and are solved
    // together. -1 if no node of the contact can move, or if its bodies sleep.
    Index region = -1;

    /// Mean force on the first body during the step [N].
    Vec3 force() const { return seconds > 0 ? Vec3(impulse / seconds) : Vec3(Vec3::Zero()); }
};

/// Computing time and number of runs of one stage of the step.
struct StageReport {
    std::string name;           // name in the form FOLDER/STAGE
    double seconds = 0;         // elapsed time of all runs of the stage [s]
    std::uint64_t runs = 0;     // number of times that the stage ran
    std::uint64_t skipped = 0;  // number of times that the stage had nothing to do
};

/// Energies of a world.
struct Energy {
    Real kinetic = 0;     // energy of the motion of all bodies [J]
    Real elastic = 0;     // energy stored by bodies, fibres, springs, and gas and liquid in cavities [J]
    Real potential = 0;   // energy of the weight, relative to the origin [J]
    Real dissipated = 0;  // energy lost since the start; see RunCounters::dissipated [J]
};

/// Report of one call of `advance`. Filling the report allocates no memory unless an error is reported. A region is a
/// group of contacts that share moving nodes or bodies; the solver solves its contacts together.
class StepReport {
public:
    /// False if a step could not be completed, or if the call was asked to stop.
    bool ok() const { return status == StepStatus::ok; }
    /// Describes the failure (the body and the reason), or states that the call was asked to stop. Empty if ok().
    std::string message() const;

    /// Warns if a body is unstable at Settings::step_size (`limited` > 0) or if an element turned inside out
    /// (`inverted` > 0). Otherwise empty.
    std::string warning() const;

    StepStatus status = StepStatus::ok;  // result of the call
    BodyHandle body;                     // the body that caused the failure; a stale handle if there is none
    Index node = -1;                     // number of the node within the body, if a node caused the failure
    // Number of the element within the body, if an element caused the failure; `node` is one of its corners
    Index element = -1;
    // Measured value that caused the failure, for three values of `status`. too_fast: norm of the change of the
    // element's deformation gradient. too_far: rounding error of positions divided by the mean edge length. too_stiff:
    // stable step [s].
    Real value = 0;
    Real step_size = 0;  // length of the last step [s]
    int steps = 0;       // number of committed steps
    // Number of attempts at a step that were repeated with a shorter step. Reasons: a body was too fast, surfaces
    // crossed, an element turned inside out, or Newton's method failed.
    int shortened = 0;
    // Number of attempts at a step that were repeated because surfaces crossed. The repeated attempt treats the
    // crossings as contacts.
    int retried = 0;
    // Number of steps that were shorter than Settings::step_size because a body is unstable at that length. The next
    // two members describe the last of these steps.
    int limited = 0;
    Real limited_step = 0;       // longest step that the body `limited_by` allowed [s]
    std::string limited_by;      // name of the body that limited the step
    Index contacts = 0;          // number of contacts of the last step, without contacts between sleeping bodies
    Index regions = 0;           // number of regions of the last step
    Index largest_region = 0;    // number of contacts of the largest region of the last step
    Index unconverged = 0;       // number of regions for which the solver did not converge, summed over the steps
    Real worst_error = 0;        // largest relative solver error of a region in any step
    Index worst_region = 0;      // number of contacts of the region with worst_error
    Real max_penetration = 0;    // largest overlap of surfaces in any step [m]
    Real max_gap_violation = 0;  // largest -Contact::gap in any step [m]
    // Largest overlap of held nodes with a collider or with another held body, in any step [m]. Contacts cannot reduce
    // such overlaps.
    Real held_penetration = 0;
    Index inverted = 0;          // number of elements that turned inside out, including those in discarded attempts
    BodyHandle inverted_body{};  // body of the first element that turned inside out
    std::string inverted_name;   // name of inverted_body
    // Number of the first element that turned inside out, in the mesh of its body.
    Index inverted_element = -1;
    // Number of crossings (a node through a triangle, or an edge through an edge) that no attempt at the step could
    // prevent.
    Index crossed = 0;
    std::string body_name;  // name of `body`; empty if there is none
};

/// Statistics about one cause that limits the length of steps. A cause is a condition (StepLimit) together with the
/// body that meets it. The statistics cover all steps since the world was made.
struct StepLimitReport {
    StepLimit limit = StepLimit::rest;  // the condition
    BodyHandle body{};        // the body; a stale handle if the condition belongs to no body (setting, crossing)
    std::string body_name;    // name of the body when it limited a step
    std::uint64_t steps = 0;  // number of steps that this cause limited
    std::uint64_t tries = 0;  // number of attempts at a step that were discarded for this cause
    Real seconds = 0;         // sum of the lengths of the steps that this cause limited [s]
};

/// The reason why BodyDynamics::automatic made a body explicit or implicit.
enum class DynamicsReason : std::uint8_t {
    given,         // `automatic` made no choice, because the user set another kind
    self_contact,  // explicit, because implicit bodies have no self-contact
    losses,        // explicit, because a material of the body sets a loss factor above 0
    plasticity,    // explicit, because a material of the body yields
    strain,        // explicit, because the expected strain is above 2 %, the limit for implicit bodies
    cost,          // implicit if the predicted cost as implicit body is below half of that as explicit body
};
template <>
struct EnumNames<DynamicsReason> {
    static constexpr std::array<std::pair<DynamicsReason, std::string_view>, 6> table{{
        {DynamicsReason::given, "given"},
        {DynamicsReason::self_contact, "self_contact"},
        {DynamicsReason::losses, "losses"},
        {DynamicsReason::plasticity, "plasticity"},
        {DynamicsReason::strain, "strain"},
        {DynamicsReason::cost, "cost"},
    }};
};

/// The estimate behind the choice of BodyDynamics::automatic (docs/methods/implicit_bodies.md 6). Steps, costs and
/// `damped_above` are estimated only if `reason` is `cost`, and are otherwise 0.
struct DynamicsEstimate {
    DynamicsReason reason = DynamicsReason::given;  // why this kind was chosen
    Real explicit_step = 0;                         // step length of the world if the body is explicit [s]
    Real implicit_step = 0;                         // step length of the world if the body is implicit [s]
    // Step length in which the deformation of the body is computed if it is implicit [s]: the larger of the member
    // implicit_step and Settings::implicit_step.
    Real deforming_step = 0;
    // Predicted computing time per simulated second on one core [s]: explicit_cost if the body is explicit,
    // implicit_cost if it is implicit. They include the elements of all bodies, and the contacts and solves of this
    // body.
    Real explicit_cost = 0, implicit_cost = 0;
    // Estimate of the largest strain: the larger of the strains by the weight of the body and by an impact
    // (docs/methods/implicit_bodies.md 6). With the initial speed u, the magnitude g of gravity, and the fall height H
    // of ten times the size of the body, the speed of the impact is sqrt(u^2 + 2 g H).
    Real strain = 0;
    // Frequency above which the steps of an implicit body damp vibrations instead of resolving them [Hz]: 1/(4 pi
    // deforming_step). At this frequency, angular frequency times deforming_step is 1/2. 0: steps damp no vibrations.
    Real damped_above = 0;
};

/// The kind that was chosen for a body added as `automatic`, and the estimate behind the choice.
struct DynamicsChoice {
    BodyHandle body{};                                       // the body that was added as `automatic`
    std::string name;                                        // name of the body
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;  // the kind that was chosen
    DynamicsEstimate estimate{};                             // predicted steps and costs of both kinds

    /// Returns a text such as "implicit: 0.8 s of CPU time per simulated second, in steps of 0.00833 s; explicit: 9 s
    /// of CPU time per simulated second, in steps of 1.4e-05 s; vibrations above 9.5 Hz are damped".
    std::string message() const;
};

/// Two bodies, or a body and a collider, that overlapped before a step. A pair is checked before the first step after
/// the user added or moved one of the two. Surfaces that only touch, or are closer than the contact distance, do not
/// overlap.
struct StartOverlap {
    BodyHandle first{};                   // the body that `depth` and `direction` refer to
    BodyHandle second{};                  // the other body; a stale handle if the partner is a collider
    ColliderHandle collider{};            // the collider; a stale handle if both partners are bodies
    std::string first_name, second_name;  // names of the two partners when the overlap was found
    // kind of the overlap, for example `inside`: `first` is inside the partner
    OverlapKind kind = OverlapKind::crossing;
    // Approximate length of the shortest translation of `first` that ends the overlap [m].
    Real depth = 0;
    Vec3 direction = Vec3::Zero();  // unit direction of the translation of `first` that ends the overlap
    Vec3 place = Vec3::Zero();      // centre of the overlapping volume [m]
    bool resolved = false;          // true if the two partners were moved apart

    /// Returns a text such as "bodies 'a' and 'b' overlap by 0.02 m at (0, 0, 0.1) m".
    std::string message() const;
};

/// A body that was moved before its first step, because it overlapped another object.
struct StartMove {
    BodyHandle body{};                // the moved body
    std::string name;                 // name of the body when it was moved
    Vec3 translation = Vec3::Zero();  // displacement of all its nodes [m]
};

/// A deformable body whose surface was found to cross itself. Surfaces are checked every 256 steps (every 128 steps if
/// there are clusters, see WorldReport::clusters) and by World::report.
struct SelfCrossing {
    BodyHandle body{};  // the body whose surface crosses itself
    std::string name;   // name of the body when the crossing was found
    // true if the body's setting self_contact was on when the crossing was last found
    bool self_contact = false;
    Real first_time = 0, last_time = 0;  // times of the first and of the last check that found a crossing [s]
    // Number of places where an edge passes through a triangle:
    // - last_places: in the last check of this surface, even if it found none,
    // - most_places: in the check with most places.
    // Places whose edge and triangle are at most one mean edge length apart in the rest shape are left out, because
    // crushed elements cause them.
    Index last_places = 0, most_places = 0;

    /// Returns a text such as "the surface of body 'knot' crosses itself in up to 312 places, first found at 0.41 s and
    /// last at 1 s".
    std::string message() const;
};

/// Sums and maxima over all steps since the world was made. A region is a group of contacts that are solved together. A
/// sweep is one pass of the solver over the contacts of a region.
struct RunCounters {
    std::uint64_t steps = 0;  // number of steps
    // Number of steps with so little work that they run on one thread, because waking other threads would take longer.
    std::uint64_t inline_steps = 0;
    std::uint64_t resting_steps = 0;  // number of steps in which all bodies are asleep and nothing moves; no stage runs
    // Number of bodies whose element forces are not computed, because the bodies fly freely and undeformed; summed over
    // all steps.
    std::uint64_t unstrained = 0;
    std::uint64_t shortened = 0;  // number of attempts at a step that were repeated with a shorter step
    // number of attempts that were repeated because surfaces crossed; the repeated attempt treats crossings as contacts
    std::uint64_t retried = 0;
    std::uint64_t limited = 0;     // number of steps shorter than step_size, because a body is unstable at step_size
    std::uint64_t inversions = 0;  // number of times that an element turned inside out
    // contact_sum: number of contacts, summed over the steps. iteration_sum: number of solver sweeps, summed over the
    // regions of all steps.
    std::uint64_t contact_sum = 0, iteration_sum = 0;
    std::uint64_t solved = 0;       // number of solved regions, summed over the steps
    std::uint64_t unconverged = 0;  // number of regions that reached the iteration limit
    std::uint64_t certified = 0;  // number of regions whose warm start was accurate enough, so that no sweep was needed
    std::uint64_t closed_form = 0;    // number of regions of one contact, solved in closed form
    std::uint64_t separating = 0;     // number of regions whose contacts all separate, so that no impulse acts
    std::uint64_t frictionless = 0;   // number of regions without friction, solved with one unknown per contact
    std::uint64_t in_lanes = 0;       // number of regions solved at once with others, one in each lane of SIMD vectors
    std::uint64_t contact_steps = 0;  // sum of (contacts times sweeps) over all regions that needed sweeps
    std::uint64_t swept = 0;          // number of regions that needed sweeps
    // number of steps for which Newton's method was used, summed over the implicit bodies (only at large strain)
    std::uint64_t large_strain_steps = 0;
    // Number of Newton iterations in these steps, and number of factorisations of the tangent stiffness.
    std::uint64_t newton_steps = 0, tangent_factors = 0;
    // Largest number of contacts and of regions in any step, and of contacts in any region.
    Index max_contacts = 0, max_regions = 0, largest_region = 0;
    Real worst_error = 0;    // largest relative solver error of a region in any step
    Index worst_region = 0;  // number of contacts of the region with worst_error
    // Energy dissipated by contacts, dampers of springs, friction of cables, damping, material losses and plastic flow,
    // and energy lost when bodies fall asleep [J]. Losses in joints are not included.
    Real dissipated = 0;
    Real plastic_work = 0;                            // part of `dissipated`: by plastic flow of elements in steps [J]
    Real max_penetration = 0, max_gap_violation = 0;  // largest values in any step; see StepReport [m]
    // Values of max_penetration and max_gap_violation in the first step alone [m].
    Real start_penetration = 0, start_gap_violation = 0;
};

/// Upper limit of the relative error of the contact impulses of a region. If a region exceeds it in any step, the
/// results of the run are not to be trusted.
inline constexpr Real largest_trusted_error = 0.5;

/// The counters of the run, and measures of the present state. To compute these measures, World::report() passes over
/// all data of the world once.
struct WorldReport : RunCounters {
    Real time = 0;           // simulated time [s]
    std::size_t asleep = 0;  // number of bodies that are asleep now
    // numbers of objects now; `elements` counts tetrahedra
    std::size_t bodies = 0, colliders = 0, nodes = 0, elements = 0;
    // Stable step of the stiffest body now [s]. If no body limits the step: the step length that advance() uses.
    Real stable_step = 0;
    std::string stable_step_body;  // name of the stiffest body; empty if no body limits the step
    // Number of clusters, number of nodes in clusters, and number of implicit elements in clusters. A cluster is a
    // group of nodes coupled by implicit elements. These elements do not shorten the step (docs/methods/clusters.md).
    std::size_t clusters = 0, cluster_nodes = 0, implicit_elements = 0;
    // Number of tetrahedra in clusters that have an inversion barrier, an additional stiffness that keeps small
    // tetrahedra from turning inside out (docs/methods/elasticity.md 7.7).
    std::size_t guards = 0;
    // choices between explicit and implicit for bodies added as `automatic`, in the order added
    std::vector<DynamicsChoice> dynamics_choices;
    // Overlaps found by the last check, and bodies that were moved to resolve them. The check runs before the first
    // step after an object was added or moved by the user.
    std::vector<StartOverlap> start_overlaps;
    std::vector<StartMove> start_moves;  // see start_overlaps
    // Bodies whose surface was found to cross itself, in the order in which they were found.
    std::vector<SelfCrossing> self_crossings;
    std::vector<StepLimitReport> step_limits;  // one entry per cause, sorted by number of steps, the largest first
    std::vector<StageReport> stages;           // stages in the order of the step
    // Averages: contacts per step, regions per step, and sweeps per solved region.
    double mean_contacts = 0, mean_regions = 0, mean_iterations = 0;
    // Searches since the start: broad_searches for pairs of near bodies, pair_searches for pairs of near features
    // (nodes, edges, triangles). candidates: number of feature pairs that the last searches found.
    std::uint64_t broad_searches = 0, pair_searches = 0, candidates = 0;
    // Sums over the run:
    // - crossing_tests: tests of near features (a node and a triangle, two edges, or a feature and a collider) that
    //   move fast enough to cross in a step,
    // - crossings_found: crossings found in discarded attempts at a step,
    // - crossed: crossings that no attempt at a step could prevent.
    std::uint64_t crossing_tests = 0, crossings_found = 0, crossed = 0;
    // Largest overlap, in any step, of held nodes with a collider or another held body [m]. No contact can reduce it.
    // The names are empty if one of the two objects was removed:
    // - held_body: name of the body with these nodes,
    // - held_in: name of the collider or body that they overlap.
    Real held_penetration = 0;
    std::string held_body, held_in;        // see held_penetration
    Energy energy;                         // present energies of the world
    Vec3 momentum = Vec3::Zero();          // momentum of all bodies [kg m/s]
    Vec3 angular_momentum = Vec3::Zero();  // angular momentum about the origin [kg m^2/s]
    // Largest errors of the balances of energy and momentum: changes that loads, weight, colliders and losses do not
    // explain. The balances are checked every 256 steps (every 128 steps if there are clusters) and now.
    //
    // A relative error is the absolute error divided by a sum of magnitudes: the present energy or momentum, plus that
    // which was exchanged.
    Real energy_error = 0, energy_error_share = 0;  // absolute error [J]; relative error [1]
    // Absolute error [kg m/s] and relative error [1] of the momentum. They are NaN if momentum is absorbed that the
    // balance does not include:
    // - by the damping of a held body,
    // - by the inertia of an implicit element with a held node. World::forces reports how much.
    Real momentum_error = 0, momentum_error_share = 0;
    // Number of steps since the balances were restarted by the last change from outside, such as an added body.
    std::uint64_t balanced_steps = 0;
    Real worst_volume_ratio = 1;    // smallest det F (volume ratio) of a tetrahedron now; negative if inverted
    std::string worst_volume_body;  // name of the body with this tetrahedron
    // Number of the tetrahedron with worst_volume_ratio, in the mesh of its body.
    Index worst_volume_element = -1;
    Index near_inversion = 0;  // number of tetrahedra with det F (volume ratio) below 0.1
    // Number of strongly compressed smoothed elements: those with less than a fifth of their rest volume. A smoothed
    // element is a union of parts of tetrahedra around an edge or a node. Strong compression reveals tetrahedra that
    // are folded against each other, although none of them is inverted.
    //
    // folded_body: the first body with such elements. folded_element: a tetrahedron of its most compressed element.
    Index folded = 0;
    std::string folded_body;    // see folded
    Index folded_element = -1;  // see folded
    Index inverted = 0;         // number of tetrahedra with det F (volume ratio) below 0
    // Angle by which the fastest rotating collider turns during the longest step allowed now [rad]. It determines an
    // error: contacts assume that points of the collider move along straight lines within a step. At the distance r
    // from the axis of rotation, the position error is r angle^2/2.
    Real collider_turn = 0;
    std::string turning_collider;  // name of the collider of collider_turn

    /// Describes why positions, forces and energies of the run cannot be trusted: surfaces passed through each other,
    /// or a contact region kept an error above largest_trusted_error. Empty if neither happened.
    std::string distrust() const;
};

}  // namespace skerry
#pragma GCC visibility pop
