// What can be set about materials, bodies, colliders and the step. SI units everywhere. Every member has an
// initialiser, so that naming some of them warns about none.
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
    Real young_modulus = 1e5;                // Pa, > 0
    Real poisson_ratio = 0.4;                // > -1 and < 0.5
    Real density = 1000;                     // kg/m^3, > 0
    Real friction = 0.5;                     // Coulomb's mu, >= 0; both of the next two unless they are given
    std::optional<Real> static_friction{};   // >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // >= 0
    Real restitution = 0;                    // of a surface point at an impact, in [0, 1]; not of the body as a whole
    Real damping = 0;                        // 1/s, >= 0: decay rate of deformation velocities; momentum is kept
    // Tangent of the angle by which strain is behind stress, at every frequency that a body of this material has: a
    // free vibration loses about 2 pi times this of its energy in a period. Rubber has 0.05 to 0.2, soft tissue 0.1 to
    // 0.3, wood 0.01, steel below 0.001. Makes the step a few per cent shorter (docs/methods/elasticity.md 6).
    Real loss_factor = 0.05;  // from 0 to 0.3
    // Damping ratio that an element has at its own highest frequency, where its volume changes.
    Real bulk_viscosity = 0.06;  // from 0 to 1
    MaterialModel model = MaterialModel::stable_neo_hookean;
};

/// How a body moves. explicit_elastic: it deforms, in steps that its stiffest element stands. implicit_elastic: it
/// deforms by linear elasticity in the frame that moves with it, and by Newton's method where strain is large, by
/// backward Euler, in any step; for what is stiff (docs/methods/implicit_bodies.md). rigid: as a whole, with the mass
/// and the inertia of its mesh; of its materials only density, friction and restitution count
/// (docs/methods/rigid_bodies.md). Rigid and implicit bodies set no step and do not touch themselves. automatic:
/// implicit where that is predicted to cost less than half as much and the body deforms by little, else explicit;
/// decided when the body is added, for the step that the bodies which are there then allow (World::dynamics_choice;
/// docs/methods/implicit_bodies.md 6).
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

/// Where a body is put. The rotation is applied first.
struct BodySettings {
    // Of all that `materials` does not name. Friction, restitution and damping of the whole body are those of this one,
    // whichever material its surface has.
    MaterialHandle material{};
    // By the label of tetrahedra (Mesh::label), each of which the mesh must have: their elasticity, density, losses
    std::map<int, MaterialHandle> materials{};
    Vec3 position = Vec3::Zero();            // m
    Vec3 rotation = Vec3::Zero();            // rad, axis times angle
    Vec3 velocity = Vec3::Zero();            // m/s
    Vec3 angular_velocity = Vec3::Zero();    // rad/s, about the centre of mass
    std::optional<Real> contact_distance{};  // m, >= 0; by default 2 % of the mean surface edge
    bool self_contact = false;
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;
    // Two touch each other if each is in a group that the mask of the other has. A bit is a group.
    std::uint32_t collision_group = 1;
    std::uint32_t collision_mask = 0xffffffffu;
    ElementKind element = ElementKind::smoothed;
    std::string name{};  // for messages and output
};

struct Plane {
    Vec3 normal = {0, 0, 1};    // any length but zero
    Vec3 point = Vec3::Zero();  // m
};
struct Sphere {
    Real radius = 1;  // m
};
struct Box {
    Vec3 size = {1, 1, 1};  // m, edge lengths
};
struct Capsule {
    Real radius = 0.5;  // m
    Real length = 1;    // m, of the straight part, along z
};
struct Cylinder {
    Real radius = 0.5;  // m
    Real height = 1;    // m, along z, centred
};
/// An open cylinder to put things into: its floor is at z = 0 of its frame.
struct Bucket {
    Real radius = 0.5;      // m, inner
    Real height = 1;        // m, inner
    Real thickness = 0.05;  // m, of wall and floor
};
using Shape = std::variant<Plane, Sphere, Box, Capsule, Cylinder, Bucket, SurfaceMesh>;

/// One key of a scripted motion; between keys position is linear and the rotation turns about a fixed axis.
struct MotionKey {
    Real time = 0;                 // s, ascending
    Vec3 position = Vec3::Zero();  // m
    Vec3 rotation = Vec3::Zero();  // rad, axis times angle
};

/// A scripted motion: constant velocities from now on, or keys at absolute times (then the velocities must be zero).
struct Motion {
    Vec3 velocity = Vec3::Zero();          // m/s
    Vec3 angular_velocity = Vec3::Zero();  // rad/s
    std::vector<MotionKey> keys{};
};

struct ColliderSettings {
    Vec3 position = Vec3::Zero();  // m
    Vec3 rotation = Vec3::Zero();  // rad, axis times angle
    Motion motion{};
    std::optional<Real> friction{};  // by default the body's own; else the geometric mean of both counts
    std::optional<Real> static_friction{}, dynamic_friction{};
    std::optional<Real> restitution{};  // by default the body's own; else the larger of both counts
    Real contact_distance = 0;          // m, shell of a mesh collider
    std::uint32_t collision_group = 1;  // as BodySettings::collision_group
    std::uint32_t collision_mask = 0xffffffffu;
    std::string name{};
};

/// Settings of the world and its step. Defaults work.
struct Settings {
    Vec3 gravity = {0, 0, -9.81};  // m/s^2
    // s, at most; by default the stable step of the stiffest body, which is never exceeded, and no more than 1/120
    // where a body is rigid or implicit
    std::optional<Real> step_size{};
    Real step_safety = 1.0;  // fraction of the stable step that is used, in (0, 1]
    // Of the steps of implicit bodies, from 0.5 to 1: 1 damps what vibrates, 0.55 a tenth as much. Less than 1 with
    // symplectic_euler only (docs/methods/implicit_bodies.md 2).
    Real theta = 1;
    // s, of the steps of implicit bodies that nothing holds, at most; 0: they take those of the others. With shorter
    // ones they take one while others take several (docs/methods/implicit_bodies.md 9). With symplectic_euler only.
    Real implicit_step = 0;
    Integrator integrator = Integrator::symplectic_euler;
    // The few elements that would make all steps several times shorter couple the nodes around them instead
    // (docs/methods/clusters.md).
    bool clusters = true;
    Backend backend = Backend::automatic;  // the first that this build has: tbb unless it was left out
    int threads = 0;                       // 0: those of the caller's task arena
    ContactRegions contact_regions = ContactRegions::separate;
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    WarmStart warm_start = WarmStart::on;
    Real tolerance = 1e-3;          // relative error of a region, docs/architecture.md
    int max_iterations = 200;       // sweeps of a region
    bool fixed_iterations = false;  // do exactly max_iterations sweeps
    Real relaxation = 1;            // of the sweeps, > 0 and < 2; only for methods that sweep
    Real restitution_speed = 0.05;  // m/s, >= 0: slower impacts do not bounce, whatever the restitution
    // m/s, > 0: what overlaps, or lies within the contact distance, is pushed apart no faster
    Real recovery_speed = 0.5;
    // Bodies that overlap each other or colliders when they are added. What is attached, or has made a step, stays.
    StartOverlaps start_overlaps = StartOverlaps::resolve;
    Real max_strain_step = 0.2;  // a step in which F of an element changes by more (Frobenius norm) is refused
    // A body that has been still for sleep_time is put to rest, together with all that it touches: it is left out of
    // the step, with its contacts as they were, until something presses on it or changes it. With `sleep` a body is
    // still that hardly moves, and neither more and more nor on and on: what stands is a thousandth of its deflection
    // from its place at most (docs/methods/skipping.md 3.1). Where sleep_speed is above 0, one all of whose nodes are
    // slower than that.
    bool sleep = true;
    Real sleep_speed = 0;   // m/s, >= 0
    Real sleep_time = 0.5;  // s, >= 0
    // Skip what cannot have come close, and steps in which nothing moves; off searches everything.
    bool contact_budgets = true;
    // A step in which surfaces would go through each other is tried again with what crossed as contacts. Only fast
    // pairs are looked at.
    bool continuous_collision = true;
    // What the solver leaves out where it can; off changes no result beyond the tolerance.
    bool certify_warm_start = true;  // no sweep where last step's impulses still solve a region
    bool skip_separating = true;     // no impulse where no contact closes
    bool frictionless_rows = true;   // one row a contact instead of three where there is no friction
    // regions of 2 to 12 contacts are solved eight at a time (method ags, friction cone)
    bool small_regions_in_lanes = true;
};

}  // namespace skerry
#pragma GCC visibility pop
