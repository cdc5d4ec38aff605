// The world: deformable bodies, colliders and attachments, and the step that moves them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "skerry/control.h"
#include "skerry/error.h"
#include "skerry/forces.h"
#include "skerry/mesh.h"
#include "skerry/query.h"
#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {
struct WorldState;  // named here, where it is not public
}

#pragma GCC visibility push(default)
namespace skerry {

struct StepProblem;  // problem.h

/// How a loaded world is run. What is not given is as it was when the world was saved; results do not depend on it.
struct LoadSettings {
    std::optional<Backend> backend{};  // one that this build does not have becomes `automatic`
    std::optional<int> threads{};
};

/// A simulation. Not safe for use from several threads at once, not even to look at; different worlds are independent.
/// Functions that take a handle throw SceneError when it is stale or of another world, functions that take settings
/// when a value is out of range, and all of them after the world was moved from.
class World {
public:
    explicit World(const Settings& settings = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // Copies and files, between calls of advance (docs/save_restore.md). They go on as this world does, bit by bit, on
    // any number of threads; every handle to what this world has names the same in them, and report() tells the whole
    // run. Functions that watch contact problems, recorded traces and seconds of stages stay behind.
    World clone() const;
    /// Writes beside `file` and renames: what was there is replaced as a whole or not at all. Throws SceneError that
    /// says what stood in the way, with the world as it was.
    void save(const std::filesystem::path& file) const;
    /// Throws SceneError that names file, data set, what was found and what was expected, unless all of the file is as
    /// save wrote it.
    static World load(const std::filesystem::path& file, const LoadSettings& settings = {});

    // Building. Allowed between calls of advance, and refused with SceneError in what these call; handles to everything
    // else stay valid. A change costs what it changes; all that is removed in a row is taken out of the tables at once,
    // when they are next needed.
    MaterialHandle add_material(const MaterialSettings& material);
    BodyHandle add_body(const Mesh& mesh, const BodySettings& body);
    /// A rigid sphere, round to contacts and queries; its nodes, faces and tetrahedra only draw it, the first is its
    /// middle (mesh::sphere_picture). `body.dynamics` must be rigid. It cannot be attached or become another kind.
    BodyHandle add_body(const Sphere& sphere, const BodySettings& body);
    /// The same of a rigid capsule, its axis along z of its frame; the first two nodes are the ends of the axis
    /// (mesh::capsule_picture). `capsule.length` > 0.
    BodyHandle add_body(const Capsule& capsule, const BodySettings& body);
    /// The same of a rigid cylinder, round about z of its frame, with flat ends and sharp rims; the first node is its
    /// middle (mesh::cylinder_picture).
    BodyHandle add_body(const Cylinder& cylinder, const BodySettings& body);
    ColliderHandle add_collider(const Shape& shape, const ColliderSettings& collider = {});
    /// Takes the freedom of nodes (local numbers) of a body: they stay where they are, or follow the motion from now
    /// on. Constant velocities turn them about `pivot`; keys are poses at absolute times, and the nodes are attached to
    /// the pose that the keys have now. Three or more not on one line hold a rigid body, or an implicit one's frame.
    AttachmentHandle attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion = {},
                            const Vec3& pivot = Vec3::Zero());
    void remove(BodyHandle body);
    void remove(ColliderHandle collider);
    void remove(AttachmentHandle attachment);
    bool alive(BodyHandle body) const;
    bool alive(ColliderHandle collider) const;
    bool alive(AttachmentHandle attachment) const;

    // Running.
    /// Looks for overlaps of what was added since the last look, and does about them what the settings say. `advance`
    /// begins with it; it may be called before to have it done, or known (WorldReport::start_overlaps). Throws
    /// SceneError, and changes nothing, where they are refused.
    void settle_start();
    /// Moves time on by dt in equal steps no longer than the stable step. A step that cannot be committed changes
    /// nothing and ends the call: the report says which body and why. Throws what settle_start throws.
    StepReport advance(Real dt);
    /// The same, but before each try of a step asks whether to go on, with the report so far. An answer of false ends
    /// the call between two steps: the report says `stopped`, and the world may go on from there.
    StepReport advance(Real dt, const std::function<bool(const StepReport&)>& go_on);
    /// From now on calls `look` after every step that is committed, with the report so far, on the thread that
    /// advances. Positions, contacts and all else can be read in it, and nothing set (with leapfrog positions are half
    /// a step further than velocities there). What it throws ends the call of advance between two steps, and comes out
    /// of it. An empty function stops it.
    void watch_steps(std::function<void(const StepReport&)> look);
    Real time() const;
    const Settings& settings() const;
    /// The step that the stiffest body stands, s: advance takes step_safety times it at most. Where all are rigid, the
    /// one that it takes.
    Real stable_step() const;

    // State of a body. Spans stay valid until bodies are added or removed; positions and velocities also change with
    // advance.
    std::span<const Vec3> positions(BodyHandle body) const;                   // m
    std::span<const Vec3> velocities(BodyHandle body) const;                  // m/s
    std::span<const std::array<Index, 3>> surface(BodyHandle body) const;     // boundary triangles, local nodes
    std::span<const std::array<Index, 4>> tetrahedra(BodyHandle body) const;  // local nodes
    /// Cauchy stress, Pa, without what relaxes (losses), and Green's strain. A tetrahedron has the mean of the elements
    /// that cover it, a node the mean of its tetrahedra by volume (docs/methods/elasticity.md 7.5), whatever their
    /// materials: where two meet stress jumps, and the nodes between them have a mean of both sides.
    std::vector<Mat3> stress(BodyHandle body) const;       // by tetrahedron
    std::vector<Mat3> strain(BodyHandle body) const;       // by tetrahedron
    std::vector<Mat3> node_stress(BodyHandle body) const;  // by node
    std::vector<Mat3> node_strain(BodyHandle body) const;  // by node
    /// node_stress of some nodes alone, in their order, from the elements around them: to the bit what it is of all.
    /// Throws where the body has no such node.
    std::vector<Mat3> node_stress(BodyHandle body, std::span<const Index> nodes) const;
    std::vector<Real> von_mises_stress(BodyHandle body) const;  // Pa, by tetrahedron
    /// The step that each tetrahedron allows as the body is now, s: that of the stiffest element that covers it. The
    /// shortest is the body's stable step, the tetrahedra that have it are those to mend.
    std::vector<Real> tetrahedron_steps(BodyHandle body) const;
    const std::string& name(BodyHandle body) const;
    /// What it has. `smoothed` is told as what it stands for: where that differs by material, as edge_node_smoothed.
    ElementKind element(BodyHandle body) const;
    BodyDynamics dynamics(BodyHandle body) const;
    /// Of one that was added as `automatic`, by what it became what it is; of others `given`.
    DynamicsEstimate dynamics_choice(BodyHandle body) const;
    /// Where the frame of its mesh is now, to which BodySettings took it at first: of a body that deforms the nearest
    /// one, which its centre of mass and its mean rotation have.
    MotionKey pose(BodyHandle body) const;
    Real mass(BodyHandle body) const;              // kg
    Vec3 center_of_mass(BodyHandle body) const;    // m
    Real contact_distance(BodyHandle body) const;  // m
    bool asleep(BodyHandle body) const;            // at rest, see Settings::sleep_speed
    void wake(BodyHandle body);                    // ends its rest; what it touches wakes within steps
    Real mean_edge(BodyHandle body) const;         // m, of the rest surface
    std::vector<BodyHandle> bodies() const;        // in the order added
    std::vector<ColliderHandle> colliders() const;
    /// Pose of a collider now: position and rotation (axis times angle). Of a plane, its point and a rotation that
    /// takes +z to its normal.
    MotionKey pose(ColliderHandle collider) const;
    /// Of the frame that carries the nodes: where it was attached it stood at the pivot, unturned, or as its keys say.
    MotionKey pose(AttachmentHandle attachment) const;
    const Shape& shape(ColliderHandle collider) const;
    const std::string& name(ColliderHandle collider) const;

    // Live control (docs/control.md), between calls of advance, refused with SceneError in what these call. Costs what
    // the change itself takes; what is derived of the whole world stays. A value that was there before changes nothing,
    // to the last bit; one that is refused changes nothing either, and the SceneError names it.
    void set_gravity(const Vec3& gravity);
    /// From now on a collider, or what an attachment holds, moves by these velocities (m/s, rad/s about the origin of
    /// its pose), until they are set again. Its script or target is forgotten.
    void set_velocity(ColliderHandle collider, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    void set_velocity(AttachmentHandle attachment, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// Moves at constant velocities, the shorter way round, so that the pose is reached after `duration` (s, > 0), and
    /// stands still from then on. With advance(duration) it is there at the end of the call.
    void move_to(ColliderHandle collider, const Pose& pose, Real duration);
    void move_to(AttachmentHandle attachment, const Pose& pose, Real duration);
    /// Is there at once and touches nothing on the way: what is in between is neither pushed nor noticed. Constant
    /// velocities go on from there, keys and targets are forgotten. What it then overlaps is treated as at a start
    /// (Settings::start_overlaps). What an attachment holds is deformed by it, or goes along as its frame does.
    void set_pose(ColliderHandle collider, const Pose& pose);
    void set_pose(AttachmentHandle attachment, const Pose& pose);
    /// Puts the nodes of a body somewhere else (m, world frame). Velocities stay, nodes that are held are held where
    /// they are put. What overlaps then is treated as at a start. Refused where it inverts elements.
    void set_positions(BodyHandle body, std::span<const Vec3> position);
    void set_velocities(BodyHandle body, std::span<const Vec3> velocity);
    /// The same as a whole: moved and turned as it is to another pose, and the velocities (m/s, rad/s) of a rigid
    /// motion about its centre of mass. A rigid body takes from set_positions what is a pose of it, else refuses them,
    /// and from set_velocities the nearest rigid motion.
    void set_pose(BodyHandle body, const Pose& pose);
    void set_velocity(BodyHandle body, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// From now on it moves as another kind of body does, under the same handle, name and settings, and counts as added
    /// last. Centre of mass, momentum and angular momentum stay, to rounding; a deformable and an implicit body take
    /// each other's shape and velocities, a rigid one has the shape of its mesh, nearest to where the nodes were: what
    /// deformed and shook it is gone. What begins to relax (losses) does so as if it had long had its shape. Refused:
    /// `automatic`; a body that is attached or has a joint, or touches itself and shall be rigid or implicit.
    void set_dynamics(BodyHandle body, BodyDynamics dynamics);
    /// External forces on the nodes, kept until set again, N.
    void set_loads(BodyHandle body, std::span<const Vec3> load);
    /// Reads or changes a material. Bodies that have it keep their shapes and velocities and get masses, stable steps
    /// and clusters of their new kind. Refused: another model; values that give one of these bodies no stable step.
    /// Kinds of smoothed elements stay what Poisson's ratio made them when their bodies were added.
    MaterialSettings material(MaterialHandle material) const;
    void set_material(MaterialHandle material, const MaterialSettings& settings);
    void set_surface_properties(BodyHandle body, const SurfaceSettings& surface);
    void set_surface_properties(ColliderHandle collider, const SurfaceSettings& surface);
    /// See BodySettings::collision_group.
    void set_collision_groups(BodyHandle body, std::uint32_t group, std::uint32_t mask);
    void set_collision_groups(ColliderHandle collider, std::uint32_t group, std::uint32_t mask);
    /// Whether two collide where their groups let them: all do, until they are switched off. A body with itself: its
    /// self_contact. Of what is switched on, overlaps are treated as at a start.
    void set_collision(BodyHandle a, BodyHandle b, bool on);
    void set_collision(BodyHandle body, ColliderHandle collider, bool on);
    /// By groups and switches.
    bool may_collide(BodyHandle a, BodyHandle b) const;
    bool may_collide(BodyHandle body, ColliderHandle collider) const;

    // Questions to the surfaces as they are now. The first one after a step fits the trees of the bodies that it looks
    // at.
    /// The first surface on the way from `origin` (m) along `direction` (any length but zero), no further than
    /// `max_distance` (m), from whichever side; nothing where there is none. Of equally near ones bodies come first, in
    /// the order added.
    std::optional<SurfaceHit> cast_ray(const Vec3& origin, const Vec3& direction, Real max_distance,
                                       const QueryFilter& filter = {}) const;
    /// The nearest point of any surface, from inside or outside; nothing within `max_distance` (m).
    std::optional<SurfaceHit> nearest_point(const Vec3& point, Real max_distance, const QueryFilter& filter = {}) const;

    // What happened.
    /// Of the last step and of what rests, in a fixed order, without those of what was removed since; none when the
    /// step was refused.
    std::span<const Contact> contacts() const;
    WorldReport report() const;
    Energy energy() const;
    /// From now on each call of advance sums up what contacts and attachments give, moments about `moment_point` (m,
    /// fixed in the world); or no longer. Changes no step. A clone goes on with it, a world that is loaded does not.
    void measure_forces(bool on, const Vec3& moment_point = Vec3::Zero());
    bool measures_forces() const;
    /// Of the last call of advance. Throws SceneError where they are not measured.
    Forces forces() const;
    /// Hash of everything that the next step depends on; equal on any number of threads and on every backend.
    std::uint64_t state_hash() const;
    /// From now on hands the contact problem of every step whose number is a multiple of `every`, and which has
    /// contacts, to `take`: after the step, on the thread that advances. Costs a copy of the velocities in these steps.
    /// An empty function stops it.
    void watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every = 1);
    /// Starts or stops recording what every worker does.
    void set_tracing(bool on);
    /// Writes what was recorded in the Trace Event Format, which Perfetto and chrome://tracing open.
    void write_trace(std::ostream& out) const;
    /// The stages of the step and which waits for which, as Graphviz dot text.
    std::string step_graph() const;

private:
    friend struct WorldAccess;
    /// Refuses use after the world was moved from.
    class StateOwner {
    public:
        explicit StateOwner(std::unique_ptr<WorldState> owned);
        ~StateOwner();
        StateOwner(StateOwner&&) noexcept;
        StateOwner& operator=(StateOwner&&) noexcept;
        WorldState& operator*() const;
        WorldState* operator->() const { return &**this; }

    private:
        std::unique_ptr<WorldState> owned_;
    };
    StateOwner state_;
};

}  // namespace skerry
#pragma GCC visibility pop
