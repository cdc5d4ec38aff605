// Settings of materials, bodies, colliders and the step, in SI units. Every member has an initialiser, so that a
// designated initialiser of some members causes no compiler warning about the others.
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
#include "components/types.h"
#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry {

inline constexpr Real largest_loss_factor = 0.3, largest_bulk_viscosity = 1;

struct MaterialSettings {
    Real young_modulus = 1e5;                // > 0 [Pa]
    Real poisson_ratio = 0.4;                // > -1 and < 0.5
    Real density = 1000;                     // > 0 [kg/m^3]
    Real friction = 0.5;                     // Coulomb's mu, >= 0: default of the next two
    std::optional<Real> static_friction{};   // >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // >= 0
    Real restitution = 0;                    // of a surface point in an impact, in [0, 1]; not of the body as a whole
    Real damping = 0;                        // decay rate of deformation velocities, >= 0 [1/s]; momentum is kept
    // Tangent of the phase angle between stress and strain, at all natural frequencies of a body. A free vibration
    // loses about 2 pi times this share of its energy in a period. Rubber has 0.05 to 0.2, soft tissue 0.1 to 0.3, wood
    // 0.01, steel below 0.001. Makes the step a few per cent shorter (docs/methods/elasticity.md 6).
    Real loss_factor = 0.05;  // from 0 to 0.3
    // Damping ratio of volume changes of an element at its own highest frequency.
    Real bulk_viscosity = 0.06;  // from 0 to 1
    MaterialModel model = MaterialModel::stable_neo_hookean;
};

/// How a body moves. Rigid and implicit bodies do not limit the step and have no self-contact.
/// - explicit_elastic: it deforms; the step must be stable for its stiffest element.
/// - rigid: it moves as a whole, with the mass and the inertia of its mesh. Of its materials only density, friction and
///   restitution count (docs/methods/rigid_bodies.md).
/// - implicit_elastic: it deforms by backward Euler (see Settings::theta), which is stable at any step size; for stiff
///   bodies. Elasticity is linear in the frame that moves with the body; large strain is solved by Newton's method
///   (docs/methods/implicit_bodies.md).
/// - automatic: implicit if the predicted cost is less than half and the body deforms little, else explicit. This is
///   decided when the body is added, for the step that the other bodies then allow (World::dynamics_choice;
///   docs/methods/implicit_bodies.md 6).
enum class BodyDynamics : std::uint8_t { explicit_elastic, rigid, implicit_elastic, automatic };
template <>
struct EnumNames<BodyDynamics> {
    static constexpr std::array<std::pair<BodyDynamics, std::string_view>, 4> table{{
        {BodyDynamics::explicit_elastic, "explicit"},
        {BodyDynamics::rigid, "rigid"},
        {BodyDynamics::implicit_elastic, "implicit"},
        {BodyDynamics::automatic, "automatic"},
    }};
};

/// Settings of a body. Its mesh is first rotated about the origin, then moved by `position`.
struct BodySettings {
    // Material of all tetrahedra that `materials` does not name. Friction, restitution and damping of the whole body
    // are those of this material, whichever material its surface has.
    MaterialHandle material{};
    // Materials of tetrahedra by their label (Mesh::label): elasticity, density and losses. The mesh must have each of
    // these labels.
    std::map<int, MaterialHandle> materials{};
    Vec3 position = Vec3::Zero();            // [m]
    Vec3 rotation = Vec3::Zero();            // axis times angle [rad]
    Vec3 velocity = Vec3::Zero();            // [m/s]
    Vec3 angular_velocity = Vec3::Zero();    // about the centre of mass [rad/s]
    std::optional<Real> contact_distance{};  // >= 0 [m]; by default 2 % of the mean surface edge
    bool self_contact = false;
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;
    // Bit sets of groups. Two objects can touch only if each is in a group that the mask of the other contains.
    std::uint32_t collision_group = 1;
    std::uint32_t collision_mask = 0xffffffffu;
    ElementKind element = ElementKind::smoothed;
    std::string name{};  // for messages and output
};

struct Plane {
    Vec3 normal = {0, 0, 1};    // any length but zero
    Vec3 point = Vec3::Zero();  // [m]
};
struct Sphere {
    Real radius = 1;  // [m]
};
struct Box {
    Vec3 size = {1, 1, 1};  // edge lengths [m]
};
struct Capsule {
    Real radius = 0.5;  // [m]
    Real length = 1;    // length of the straight part, along z [m]
};
struct Cylinder {
    Real radius = 0.5;  // [m]
    Real height = 1;    // along z, centred [m]
};
/// An open cylindrical container. The inner side of its floor is at z = 0 of its frame.
struct Bucket {
    Real radius = 0.5;      // inner [m]
    Real height = 1;        // inner [m]
    Real thickness = 0.05;  // of wall and floor [m]
};
using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, Bucket, SurfaceMesh>;

/// One key of a scripted motion. Between keys the position is linear and the rotation turns about a fixed axis.
struct MotionKey {
    Real time = 0;                 // ascending from key to key [s]
    Vec3 position = Vec3::Zero();  // [m]
    Vec3 rotation = Vec3::Zero();  // axis times angle [rad]
};

/// A scripted motion: constant velocities from now on, or keys at absolute times. With keys the velocities must be
/// zero.
struct Motion {
    Vec3 velocity = Vec3::Zero();          // [m/s]
    Vec3 angular_velocity = Vec3::Zero();  // [rad/s]
    std::vector<MotionKey> keys{};
};

struct ColliderSettings {
    Vec3 position = Vec3::Zero();  // [m]
    Vec3 rotation = Vec3::Zero();  // axis times angle [rad]
    Motion motion{};
    std::optional<Real> friction{};  // default: the value of the body; if given, the geometric mean of both is used
    std::optional<Real> static_friction{}, dynamic_friction{};
    std::optional<Real> restitution{};  // default: the value of the body; if given, the larger of both is used
    Real contact_distance = 0;          // thickness of the contact shell of a mesh collider [m]
    std::uint32_t collision_group = 1;  // see BodySettings::collision_group
    std::uint32_t collision_mask = 0xffffffffu;
    std::string name{};
};

/// Settings of the world and its step. The defaults suit most scenes.
struct Settings {
    // Acceleration of all bodies [m/s^2]. Change it when your vertical axis is not z, or when there is no gravity.
    Vec3 gravity = {0, 0, -9.81};
    // Upper bound of the step [s]. The stable step of the stiffest body is never exceeded and is the default; with a
    // rigid or implicit body the default is at most 1/120 s. Change it when you need smaller errors in time, or equal
    // steps in several runs.
    std::optional<Real> step_size{};
    // Parameter of the theta method for implicit bodies, from 0.5 to 1. 1 (backward Euler) damps vibrations, 0.55 a
    // tenth as much. Values below 1 require symplectic_euler (docs/methods/implicit_bodies.md 2). Change it when an
    // implicit body must go on vibrating.
    Real theta = 1;
    // Upper bound of the step of implicit bodies that nothing holds [s]; 0: they take the steps of the other bodies. If
    // those are shorter, implicit bodies take one step while the others take several (docs/methods/implicit_bodies.md
    // 9). Requires symplectic_euler. Change it when implicit bodies take most of the time beside explicit ones.
    Real implicit_step = 0;
    // Time integrator (docs/integration.md). Change it to leapfrog when smooth motion must be exact to second order.
    Integrator integrator = Integrator::symplectic_euler;
    // Treat the few elements that would make all steps several times shorter implicitly, by coupling the nodes around
    // them (docs/methods/clusters.md). Change it when all elements of explicit bodies must be integrated explicitly.
    bool clusters = true;
    // Thread library; automatic: the first that this build has, tbb unless it was left out. Change it when your program
    // already uses another one.
    Backend backend = Backend::automatic;
    // Number of threads; 0: those of the caller's task arena. Change it when other work shares the processor.
    int threads = 0;
    // separate: contacts that do not influence each other are solved apart. Change it to global when you compare
    // solvers on one large problem.
    ContactRegions contact_regions = ContactRegions::separate;
    // Contact solver. Change it when you compare solvers, or when contacts stay unconverged (docs/solvers.md).
    SolverMethod method = SolverMethod::automatic;
    // Friction law. Change it to pyramid when you compare with the paper, which uses that approximation.
    Friction friction = Friction::cone;
    // Relative error of the impulses of a region (docs/architecture.md). Change it when contact forces must be more
    // exact, or when larger errors are fine and speed matters.
    Real tolerance = 1e-3;
    // Largest number of sweeps of a region. Change it when a run reports unconverged regions.
    int max_iterations = 200;
    // Largest speed at which surfaces that overlap or are closer than the contact distance are pushed apart, > 0 [m/s].
    // Change it when bodies are so small or so slow that this speed disturbs them.
    Real recovery_speed = 0.5;
    // Treatment of bodies that overlap each other or colliders when they are added. Bodies that are attached or have
    // made a step are not moved. Change it when no body may be moved at the start.
    StartOverlaps start_overlaps = StartOverlaps::resolve;
    // A body that has been still for sleep_time is put to rest, together with all bodies that it touches. It is left
    // out of the step, and its contacts stay as they are, until something presses on it or changes it. A body is still
    // if it hardly moves and its motion neither grows nor goes on steadily. Its distance from equilibrium is then at
    // most a thousandth of its deflection (docs/methods/skipping.md 3.1). Change it when you study motion below
    // these limits.
    bool sleep = true;
    // See `sleep`; >= 0 [s]. Change it when bodies come to rest too early or too late.
    Real sleep_time = 0.5;
    // Repeat a step in which surfaces would go through each other, with the crossing features as contacts. Only fast
    // pairs are tested. Change it when surfaces may pass through each other and the tests cost too much time.
    bool continuous_collision = true;
};

}  // namespace skerry
#pragma GCC visibility pop
