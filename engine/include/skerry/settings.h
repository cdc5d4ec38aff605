// Settings of materials, bodies, colliders and the step, in SI units. Every member has an initial value, so that
// compilers do not warn about members that a designated initialiser leaves out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "components/handle.h"
#include "components/options.h"
#include "components/orthotropic_moduli.h"
#include "components/types.h"
#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry {

inline constexpr Real default_loss_factor = 0.05;  // loss factor of explicit bodies whose material gives none
inline constexpr Real largest_loss_factor = 0.3;   // upper limit of MaterialSettings::loss_factor
inline constexpr Real largest_bulk_viscosity = 1;  // upper limit of MaterialSettings::bulk_viscosity

/// Term of the law `ogden` (Ogden 1972; docs/methods/elasticity.md 2.5).
struct StretchTerm {
    Real share = 0;     // share of the term in the shear modulus, from 0 (the term is not used) to 1
    Real exponent = 2;  // exponent of the principal stretches; its magnitude is from 0.1 to 100

    bool operator==(const StretchTerm&) const = default;
};

/// Plasticity of von Mises with isotropic hardening, for the material law `hencky` (docs/methods/elasticity.md 8).
struct Plasticity {
    Real yield_stress = 0;  // von Mises stress at which the material yields first, > 0 [Pa]
    Real hardening = 0;     // increase of the yield stress per equivalent plastic strain, >= 0 [Pa]

    bool operator==(const Plasticity&) const = default;
};

/// Elasticity, losses, friction and plasticity of a material.
struct MaterialSettings {
    Real young_modulus = 1e5;  // Young's modulus at small strain, > 0 [Pa]
    Real poisson_ratio = 0.4;  // Poisson's ratio, > -1 and < 0.5
    Real density = 1000;       // mass per volume of the rest shape, > 0 [kg/m^3]
    // Coulomb's friction coefficient, >= 0. It is the default of static_friction and dynamic_friction.
    Real friction = 0.5;
    std::optional<Real> static_friction{};   // friction coefficient of sticking contacts, >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // friction coefficient of sliding contacts, >= 0
    // Rebound speed over impact speed of a surface point (not of the whole body), from 0 to 1.
    Real restitution = 0;
    // Decay rate of velocities, >= 0 [1/s]. In a free body, velocities relative to its rigid motion decay, so momentum
    // is conserved. In a body with held nodes, velocities relative to the world decay.
    Real damping = 0;
    // Tangent of the phase angle between stress and strain, nearly constant over the natural frequencies of a body
    // (docs/methods/elasticity.md 6). In each period a free vibration loses about the fraction 2 pi loss_factor of its
    // energy.
    // - Typical values: rubber 0.05 to 0.2, soft tissue 0.1 to 0.3, wood 0.01, steel below 0.001.
    // - Not given: explicit bodies have default_loss_factor, implicit bodies no such losses.
    // - Above 0: the stable step is a few per cent shorter, `implicit` is refused, and `automatic` makes the body
    //   explicit.
    std::optional<Real> loss_factor{};  // from 0 to 0.3
    // Damping ratio of volume changes of an element, at the highest natural frequency of this element. Implicit bodies
    // do not use this value.
    Real bulk_viscosity = 0.06;                               // from 0 to 1
    MaterialModel model = MaterialModel::stable_neo_hookean;  // elastic law
    // Terms of the law `ogden`, whose shares sum to 1. ogden() and mooney_rivlin() of materials.h set them from moduli.
    std::array<StretchTerm, 3> terms{{{1, 2}, {}, {}}};
    // Elastic constants of the law `orthotropic`.
    //
    // Viscous stress (loss_factor, bulk_viscosity) and estimates, such as that of the expected strain, use an isotropic
    // material instead. It is at most as stiff as the orthotropic one for every strain. young_modulus and poisson_ratio
    // are replaced by the constants of this isotropic material.
    OrthotropicModuli orthotropic{};
    std::optional<Plasticity> plasticity{};  // only with the law `hencky`, and only for explicit bodies
};

/// Kind of motion of a body. Rigid and implicit bodies do not limit the step and have no self-contact.
enum class BodyDynamics : std::uint8_t {
    explicit_elastic,  // the body deforms, and the step must be stable for its stiffest element
    // The body does not deform. It has the mass and the inertia of its mesh, or given ones. From its materials it uses
    // only density, friction and restitution (docs/methods/rigid_bodies.md).
    rigid,
    // The body deforms by backward Euler (see Settings::theta), which is stable at any step length and suits stiff
    // bodies (docs/methods/implicit_bodies.md). At strains up to about 2 %, elasticity is linear in the frame that
    // moves with the body. At larger strains it follows the material law, and Newton's method solves each step.
    implicit_elastic,
    // The engine chooses when the body is added (docs/methods/implicit_bodies.md 6, World::dynamics_choice). The body
    // becomes implicit under two conditions, otherwise explicit:
    // - The predicted cost of the scene is less than half of the cost with this body explicit. Both costs are predicted
    //   for the step length that the bodies added earlier allow.
    // - The expected strain is at most 2 %.
    // If a body added later requires much shorter steps, the costs are compared again. An implicit body can then become
    // explicit, as by World::set_dynamics().
    automatic,
};
template <>
struct EnumNames<BodyDynamics> {
    static constexpr std::array<std::pair<BodyDynamics, std::string_view>, 4> table{{
        {BodyDynamics::explicit_elastic, "explicit"},
        {BodyDynamics::rigid, "rigid"},
        {BodyDynamics::implicit_elastic, "implicit"},
        {BodyDynamics::automatic, "automatic"},
    }};
};

/// Settings of a body. The mesh is first rotated about its origin, then moved by `position`.
struct BodySettings {
    // Material of all tetrahedra to which `materials` and `materials_of_sets` give none. The whole body has the
    // friction, restitution and damping of this material, even where tetrahedra at the surface have another one.
    MaterialHandle material{};
    // Materials of tetrahedra by label (Mesh::label). These materials determine elasticity, density and losses of the
    // tetrahedra. Each label must occur in the mesh.
    std::map<int, MaterialHandle> materials{};
    // Materials of the tetrahedra of named sets (Mesh::sets). They take precedence over `materials`. A tetrahedron must
    // not be in two of these sets.
    std::map<std::string, MaterialHandle> materials_of_sets{};
    Vec3 position = Vec3::Zero();          // initial position of the origin of the mesh in the world [m]
    Vec3 rotation = Vec3::Zero();          // initial rotation: axis times angle [rad]
    Vec3 velocity = Vec3::Zero();          // initial velocity of the centre of mass [m/s]
    Vec3 angular_velocity = Vec3::Zero();  // initial angular velocity about the centre of mass [rad/s]
    // Contact distance, >= 0: contacts act where two surfaces are closer than this. Between two bodies, the mean of
    // their contact distances applies. Default: 2 % of the mean edge length of the surface [m].
    std::optional<Real> contact_distance{};
    bool self_contact = false;                        // true: contacts act between parts of the surface of the body
    BodyDynamics dynamics = BodyDynamics::automatic;  // how the body moves
    // Mass properties of a rigid body. If none are given, they follow from the shape and the densities. `mass` alone
    // scales the densities. If `center_of_mass` or `inertia` is given, all three must be given. Centre and inertia
    // tensor are in the frame of the mesh; the tensor is about the centre of mass.
    std::optional<Real> mass{};            // mass of the body, > 0 [kg]
    std::optional<Vec3> center_of_mass{};  // centre of mass in the frame of the mesh [m]
    std::optional<Mat3> inertia{};         // inertia tensor, symmetric and positive definite [kg m^2]
    // Groups of the body, as bits. Two objects can touch only if the mask of each contains a group of the other.
    std::uint32_t collision_group = 1;
    std::uint32_t collision_mask = 0xffffffffu;   // groups that the body can touch, as bits; default: all groups
    ElementKind element = ElementKind::smoothed;  // finite elements of a deformable body
    std::string name{};                           // name of the body in messages and output
};

/// A solid half-space bounded by a plane. The normal points out of the solid.
struct Plane {
    Vec3 normal = {0, 0, 1};    // normal vector, of any length except zero
    Vec3 point = Vec3::Zero();  // a point of the plane [m]
};
/// A sphere around the origin of its frame.
struct Sphere {
    Real radius = 1;  // [m]
};
/// A box around the origin of its frame.
struct Box {
    Vec3 size = {1, 1, 1};  // edge lengths [m]
};
/// A cylinder with hemispheres at its ends, around the origin of its frame. The axis is z.
struct Capsule {
    Real radius = 0.5;  // [m]
    Real length = 1;    // length of the straight part, along z [m]
};
/// A cylinder with flat ends, around the origin of its frame. The axis is z.
struct Cylinder {
    Real radius = 0.5;  // [m]
    Real height = 1;    // height along z, from -height / 2 to height / 2 [m]
};
/// An open cylindrical container. In its own frame the inner side of the floor lies at z = 0.
struct Bucket {
    Real radius = 0.5;      // inner radius [m]
    Real height = 1;        // inner height [m]
    Real thickness = 0.05;  // thickness of wall and floor [m]
};
/// The shape of a collider.
using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, Bucket, SurfaceMesh>;

/// One keyframe of a scripted motion. Between keyframes the velocity is constant, and the rotation is about a fixed
/// axis at constant speed.
struct MotionKey {
    Real time = 0;                 // time, which must increase from key to key [s]
    Vec3 position = Vec3::Zero();  // position of the origin of the frame of the moved object in the world [m]
    Vec3 rotation = Vec3::Zero();  // rotation axis times angle [rad]
};

/// A scripted motion: either constant velocities from the time at which the motion is given, or keyframes at absolute
/// times. With keyframes both velocities must be zero.
struct Motion {
    Vec3 velocity = Vec3::Zero();          // constant velocity [m/s]
    Vec3 angular_velocity = Vec3::Zero();  // constant angular velocity [rad/s]
    std::vector<MotionKey> keys{};         // poses at ascending times; empty: the velocities apply

    /// True if a key has a rotation.
    bool turns() const {
        for (const MotionKey& key : keys)
            if (!key.rotation.isZero(0)) return true;
        return false;
    }
};

/// Pose, motion and surface properties of a collider.
struct ColliderSettings {
    Vec3 position = Vec3::Zero();  // position of the origin of the shape's frame in the world [m]
    Vec3 rotation = Vec3::Zero();  // rotation axis times angle [rad]
    // Scripted motion. Its keys are poses of the collider in the world, as World::pose returns them. They replace
    // `position` and `rotation`, and for a plane also Plane::point and Plane::normal. If no key has a rotation, the
    // collider keeps `rotation`, and a plane its normal.
    Motion motion{};
    // Friction coefficient, >= 0. If given, a contact uses the geometric mean of this value and that of the body. If
    // not given, a contact uses the value of the body.
    std::optional<Real> friction{};
    std::optional<Real> static_friction{}, dynamic_friction{};  // see MaterialSettings; default of each: `friction`
    // Coefficient of restitution, from 0 to 1. If given, a contact uses the larger of this value and that of the body.
    // If not given, a contact uses the value of the body.
    std::optional<Real> restitution{};
    Real contact_distance = 0;                   // contact distance of a mesh collider, >= 0 [m]
    std::uint32_t collision_group = 1;           // see BodySettings::collision_group
    std::uint32_t collision_mask = 0xffffffffu;  // see BodySettings::collision_group
    std::string name{};                          // name of the collider in messages and output
};

/// Settings of the world and its step. The defaults suit most scenes.
struct Settings {
    // Acceleration of all bodies [m/s^2]. Change it when your vertical axis is not z, or when there is no gravity.
    Vec3 gravity = {0, 0, -9.81};
    // Upper limit of the step length [s]. Default: the stable step of the stiffest body, but at most 1/120 s if the
    // world has a rigid or implicit body. Even with a larger value, steps never exceed the stable step. Change it when
    // you need smaller errors in time, or steps of equal length in several runs.
    std::optional<Real> step_size{};
    // Parameter theta of the theta method for implicit bodies, from 0.5 to 1. The value 1 is backward Euler, which
    // damps vibrations. The value 0.55 causes a tenth of this damping. Values below 1 require the integrator
    // symplectic_euler (docs/methods/implicit_bodies.md 2). Change it when an implicit body must keep vibrating.
    Real theta = 1;
    // Upper limit of the step length of implicit bodies without attachments [s]. Change it when implicit bodies take
    // most of the computing time beside explicit ones. Values above 0 require the integrator symplectic_euler.
    // - 0: implicit bodies use the step length of the other bodies.
    // - Above 0: an implicit body takes one long step while other bodies that need shorter steps take several
    //   (docs/methods/implicit_bodies.md 9).
    Real implicit_step = 0;
    // Time integrator (docs/step_length.md). Change it to leapfrog when smooth motion must be exact to second order.
    Integrator integrator = Integrator::symplectic_euler;
    // If true, elements of explicit bodies whose stable step is much shorter than that of the other elements are
    // integrated implicitly. Nodes that such elements connect form a cluster (docs/methods/clusters.md). Change it when
    // all elements of explicit bodies must be integrated explicitly.
    bool clusters = true;
    // Thread library. `automatic` selects the first library of this build, which is tbb unless tbb was left out. Change
    // it when your program already uses another library.
    Backend backend = Backend::automatic;
    // Number of threads. 0: with tbb as many as the caller's tbb::task_arena has, with openmp omp_get_max_threads(),
    // with threads one per core. Change it when other work shares the processor.
    int threads = 0;
    // Division of contacts into regions. With `separate`, contacts that do not influence each other are solved
    // separately. Change it to `global` when you compare solvers on one large problem.
    ContactRegions contact_regions = ContactRegions::separate;
    // Contact solver. Change it when you compare solvers, or when contacts stay unconverged (docs/solvers.md).
    SolverMethod method = SolverMethod::automatic;
    // Friction law. Change it to pyramid when you compare with Lazarevych et al. (2010), who use this approximation.
    Friction friction = Friction::cone;
    // The solver accepts the contact impulses of a region if their relative error is at most this value
    // (docs/methods/errors.md). Change it when contact forces must be more exact, or when larger errors are fine and
    // speed matters.
    Real tolerance = 1e-3;
    // Largest number of solver sweeps over the contacts of a region. Change it when a run reports unconverged regions.
    int max_iterations = 200;
    // Surfaces that overlap or are closer than the contact distance are pushed apart, at most at this speed, > 0 [m/s].
    // Change it when bodies are so small or so slow that this speed disturbs them.
    Real recovery_speed = 0.5;
    // Treatment of bodies that overlap other bodies or colliders after you added or moved one of the two. Bodies that
    // are attached or have already made a step are never moved. Change it when no body may be moved at the start.
    StartOverlaps start_overlaps = StartOverlaps::resolve;
    // If true, bodies that touch or are joined fall asleep together when each of them has been still for sleep_time.
    // Change it when you study slower or smaller motion. Steps leave sleeping bodies and their contacts unchanged,
    // until another object presses on such a body, or you change the body.
    //
    // A body is still if it hardly moves, becomes no faster, and does not move steadily in one direction
    // (docs/methods/skipping.md 3.1). It is then near its equilibrium: the remaining distance is at most about a
    // thousandth of its deflection under its weight.
    bool sleep = true;
    // Time for which a body must be still before it falls asleep, >= 0 [s]. Change it when bodies fall asleep too early
    // or too late.
    Real sleep_time = 0.5;
    // If true, a step in which surfaces would pass through each other is repeated, with contacts between the features
    // (nodes, edges, triangles) that crossed. Only features that move fast enough to meet in the step are tested.
    // Change it when these tests cost too much time, and surfaces that pass through each other do no harm.
    bool continuous_collision = true;
};

}  // namespace skerry
#pragma GCC visibility pop
