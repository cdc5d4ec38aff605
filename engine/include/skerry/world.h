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
struct WorldState;  // internal; declared outside the block of public symbols
}

#pragma GCC visibility push(default)
namespace skerry {

struct StepProblem;  // defined in problem.h

/// How a loaded world is run. Values that are not given are those of the saved world. Results do not depend on them.
struct LoadSettings {
    std::optional<Backend> backend{};  // a backend that this build does not have becomes `automatic`
    std::optional<int> threads{};
};

/// A simulation. A world must not be used by several threads at once, not even for reading; different worlds are
/// independent. Functions throw SceneError if a handle is stale or belongs to another world, if a setting is out of
/// range, or if the world was moved from.
class World {
public:
    explicit World(const Settings& settings = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // Copies and files, between calls of advance (docs/save_restore.md). A copy continues like this world, bit by bit,
    // on any number of threads. Handles of this world name the same objects in the copy, and its report() covers the
    // whole run. Functions that watch steps or contact problems, recorded traces and seconds of stages are not copied.
    World clone() const;
    /// Writes a file beside `file` and renames it: an existing file is replaced as a whole or not at all. Throws
    /// SceneError that names the obstacle; the world is unchanged.
    void save(const std::filesystem::path& file) const;
    /// Reads a world that save() wrote. If any part of the file is different, throws SceneError that names the file,
    /// the data set, and the found and the expected value.
    static World load(const std::filesystem::path& file, const LoadSettings& settings = {});

    // Building, between calls of advance; in callbacks of advance these functions throw SceneError. Handles to all
    // other objects stay valid. The cost of a change depends on the size of the changed object only. Consecutive
    // removals are carried out together, when the tables are needed next.
    MaterialHandle add_material(const MaterialSettings& material);
    BodyHandle add_body(const Mesh& mesh, const BodySettings& body);
    /// Adds a rigid sphere. Contacts and queries use the exact sphere; its nodes, faces and tetrahedra are for output
    /// only (mesh::sphere_picture), and the first node is the centre. `body.dynamics` must be rigid. The sphere cannot
    /// be attached or become another kind of body.
    BodyHandle add_body(const Sphere& sphere, const BodySettings& body);
    /// Adds a rigid capsule; see add_body() for a sphere. Its axis is z of its frame, and its first two nodes are the
    /// ends of the axis (mesh::capsule_picture). `capsule.length` must be > 0.
    BodyHandle add_body(const Capsule& capsule, const BodySettings& body);
    /// Adds a rigid cylinder with flat ends and sharp rims; see add_body() for a sphere. Its axis is z of its frame,
    /// and its first node is the centre (mesh::cylinder_picture).
    BodyHandle add_body(const Cylinder& cylinder, const BodySettings& body);
    ColliderHandle add_collider(const Shape& shape, const ColliderSettings& collider = {});
    /// Prescribes the motion of nodes (local numbers) of a body: they stay in place or follow `motion` from now on.
    /// Constant angular velocities turn them about `pivot`. Keys are poses at absolute times, and the nodes are
    /// attached to the pose that the keys have now. For a rigid or implicit body three or more nodes that are not on
    /// one line are required; they hold the whole rigid body, or the frame of the implicit one.
    AttachmentHandle attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion = {},
                            const Vec3& pivot = Vec3::Zero());
    void remove(BodyHandle body);
    void remove(ColliderHandle collider);
    void remove(AttachmentHandle attachment);
    bool alive(BodyHandle body) const;
    bool alive(ColliderHandle collider) const;
    bool alive(AttachmentHandle attachment) const;

    // Running the simulation.
    /// Finds overlaps of bodies and colliders that were added or put elsewhere since the last check, and treats them
    /// according to Settings::start_overlaps. Every advance() begins with this. An earlier call makes the result known
    /// (WorldReport::start_overlaps). If overlaps are refused, throws SceneError and changes nothing.
    void settle_start();
    /// Advances time by dt [s] in equal steps no longer than the stable step. A step that cannot be committed changes
    /// nothing and ends the call; the report names the body and the reason. Throws the errors of settle_start().
    StepReport advance(Real dt);
    /// Advances like advance(dt), but calls `go_on` with the report so far before each try of a step. If it returns
    /// false, the call ends between two steps: the report has the status `stopped`, and the world can be advanced
    /// further.
    StepReport advance(Real dt, const std::function<bool(const StepReport&)>& go_on);
    /// From now on calls `look` after every committed step, with the report so far, on the thread that advances. It may
    /// read the whole state, but must not change the world. With leapfrog, positions are half a step ahead of
    /// velocities there. An exception of `look` ends the call of advance between two steps and is rethrown by it. An
    /// empty function ends the calls.
    void watch_steps(std::function<void(const StepReport&)> look);
    Real time() const;
    const Settings& settings() const;
    /// Stable step of the stiffest body [s]; advance() takes no longer steps. If all bodies are rigid or implicit, the
    /// step that advance() takes.
    Real stable_step() const;

    // State of a body. Spans are valid until bodies are added or removed; advance() changes the positions and
    // velocities in them.
    std::span<const Vec3> positions(BodyHandle body) const;                   // [m]
    std::span<const Vec3> velocities(BodyHandle body) const;                  // [m/s]
    std::span<const std::array<Index, 3>> surface(BodyHandle body) const;     // boundary triangles, local nodes
    std::span<const std::array<Index, 4>> tetrahedra(BodyHandle body) const;  // local nodes
    /// Cauchy stress [Pa] without the relaxing part of the losses, and Green strain. A tetrahedron has the mean of the
    /// elements that cover it, a node the volume-weighted mean of its tetrahedra (docs/methods/elasticity.md 7.5).
    /// Stress jumps between two materials, and the nodes between them have the mean of both sides.
    std::vector<Mat3> stress(BodyHandle body) const;       // by tetrahedron
    std::vector<Mat3> strain(BodyHandle body) const;       // by tetrahedron
    std::vector<Mat3> node_stress(BodyHandle body) const;  // by node
    std::vector<Mat3> node_strain(BodyHandle body) const;  // by node
    /// Stress at some nodes only, in the given order, from the elements around them. The values are bitwise those of
    /// node_stress(body). Throws SceneError if the body has no such node.
    std::vector<Mat3> node_stress(BodyHandle body, std::span<const Index> nodes) const;
    std::vector<Real> von_mises_stress(BodyHandle body) const;  // by tetrahedron [Pa]
    /// Step that each tetrahedron allows in the present shape of the body [s]: that of the stiffest element that covers
    /// it. The shortest one is the stable step of the body; the tetrahedra that have it are those to repair.
    std::vector<Real> tetrahedron_steps(BodyHandle body) const;
    const std::string& name(BodyHandle body) const;
    /// Kind of the elements. Instead of `smoothed` it is the resolved kind; if that depends on the material,
    /// edge_node_smoothed.
    ElementKind element(BodyHandle body) const;
    BodyDynamics dynamics(BodyHandle body) const;
    /// For a body added with `automatic`: the cost estimate behind the choice. For all others `reason` is `given`.
    DynamicsEstimate dynamics_choice(BodyHandle body) const;
    /// Present pose of the mesh frame, initially that of BodySettings. For a deformed body it is the best fit, given by
    /// the centre of mass and the mean rotation.
    MotionKey pose(BodyHandle body) const;
    Real mass(BodyHandle body) const;              // [kg]
    Vec3 center_of_mass(BodyHandle body) const;    // [m]
    Real contact_distance(BodyHandle body) const;  // [m]
    bool asleep(BodyHandle body) const;            // at rest, see Settings::sleep
    void wake(BodyHandle body);                    // ends its rest; bodies that it touches wake in later steps
    Real mean_edge(BodyHandle body) const;         // mean edge length of the rest surface [m]
    std::vector<BodyHandle> bodies() const;        // in the order added
    std::vector<ColliderHandle> colliders() const;
    /// Present pose of a collider: position and rotation (axis times angle). For a plane: its point and a rotation that
    /// takes +z to its normal.
    MotionKey pose(ColliderHandle collider) const;
    /// Present pose of the frame that carries the nodes. When attached, it was at the pivot without rotation, or at the
    /// pose of the keys.
    MotionKey pose(AttachmentHandle attachment) const;
    const Shape& shape(ColliderHandle collider) const;
    const std::string& name(ColliderHandle collider) const;

    // Live control (docs/control.md), between calls of advance; in callbacks of advance these functions throw
    // SceneError. A change costs only the update of the changed object; data derived from the whole world stay. Setting
    // the present value again changes no bit. A refused value changes nothing, and the SceneError names it.
    void set_gravity(const Vec3& gravity);
    /// From now on a collider, or the nodes of an attachment, move at these velocities [m/s, rad/s about the origin of
    /// the pose] until they are set again. An earlier script or target is dropped.
    void set_velocity(ColliderHandle collider, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    void set_velocity(AttachmentHandle attachment, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// Moves at constant velocities, with the smaller of the two possible rotations, so that the pose is reached after
    /// `duration` (> 0 [s]), and then stops. advance(duration) ends at this pose.
    void move_to(ColliderHandle collider, const Pose& pose, Real duration);
    void move_to(AttachmentHandle attachment, const Pose& pose, Real duration);
    /// Jumps to a pose. Objects on the way are neither pushed nor detected. Constant velocities continue from there,
    /// keys and targets are dropped. Settings::start_overlaps applies to new overlaps. A body held by the attachment is
    /// deformed; if the attachment holds a whole rigid body or the frame of an implicit one, this moves along.
    void set_pose(ColliderHandle collider, const Pose& pose);
    void set_pose(AttachmentHandle attachment, const Pose& pose);
    /// Sets the positions of all nodes of a body [m, world frame]. Velocities stay, and attached nodes are held at
    /// their new positions. Settings::start_overlaps applies to new overlaps. Throws SceneError if an element would be
    /// inverted.
    void set_positions(BodyHandle body, std::span<const Vec3> position);
    void set_velocities(BodyHandle body, std::span<const Vec3> velocity);
    /// Moves a body in its present shape to another pose, or gives all nodes the velocities of a rigid motion about the
    /// centre of mass [m/s, rad/s]. A rigid body accepts only positions that are a pose of it in set_positions(), and
    /// takes the nearest rigid motion in set_velocities().
    void set_pose(BodyHandle body, const Pose& pose);
    void set_velocity(BodyHandle body, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// Changes the kind of a body. Handle, name and settings stay, and the body counts as added last. Centre of mass,
    /// momentum and angular momentum stay, to rounding. Shape and velocities are taken over between explicit and
    /// implicit bodies. A rigid body has the shape of its mesh, fitted to the nodes; energy of deformation and
    /// vibration is lost. An explicit body starts with fully relaxed losses, as if it had long had its shape. Throws
    /// SceneError for `automatic`, for a body that is attached or has a joint or is a sphere, capsule or cylinder, and
    /// for a body with self-contact that is to be rigid or implicit.
    void set_dynamics(BodyHandle body, BodyDynamics dynamics);
    /// External forces on the nodes, kept until set again [N].
    void set_loads(BodyHandle body, std::span<const Vec3> load);
    /// Reads or changes a material. Bodies of this material keep their shapes and velocities and get new masses, stable
    /// steps and clusters. Throws SceneError for another model and for values that give one of these bodies no stable
    /// step. The kind of smoothed elements stays as Poisson's ratio determined it when the body was added.
    MaterialSettings material(MaterialHandle material) const;
    void set_material(MaterialHandle material, const MaterialSettings& settings);
    void set_surface_properties(BodyHandle body, const SurfaceSettings& surface);
    void set_surface_properties(ColliderHandle collider, const SurfaceSettings& surface);
    /// See BodySettings::collision_group.
    void set_collision_groups(BodyHandle body, std::uint32_t group, std::uint32_t mask);
    void set_collision_groups(ColliderHandle collider, std::uint32_t group, std::uint32_t mask);
    /// Switches the collision of a pair on or off; initially all pairs that their groups admit are on. For a body with
    /// itself it sets self_contact. Settings::start_overlaps applies to a pair that is switched on.
    void set_collision(BodyHandle a, BodyHandle b, bool on);
    void set_collision(BodyHandle body, ColliderHandle collider, bool on);
    /// True if groups and switches let the two collide.
    bool may_collide(BodyHandle a, BodyHandle b) const;
    bool may_collide(BodyHandle body, ColliderHandle collider) const;

    // Queries of the present surfaces. The first query after a step refits the bounding volume trees of the bodies that
    // it tests.
    /// First surface hit by a ray from `origin` [m] along `direction` (any length but zero) within `max_distance` [m],
    /// from either side; empty if there is none. Of equally near surfaces those of bodies come first, in the order
    /// added.
    std::optional<SurfaceHit> cast_ray(const Vec3& origin, const Vec3& direction, Real max_distance,
                                       const QueryFilter& filter = {}) const;
    /// Nearest point of any surface, from inside or outside; empty if there is none within `max_distance` [m].
    std::optional<SurfaceHit> nearest_point(const Vec3& point, Real max_distance, const QueryFilter& filter = {}) const;

    // Results.
    /// Contacts of the last step and between bodies at rest, in a fixed order, without those of objects removed since.
    /// Empty if the last step was refused.
    std::span<const Contact> contacts() const;
    WorldReport report() const;
    Energy energy() const;
    /// Switches on or off that each call of advance sums the forces of contacts and attachments, with moments about
    /// `moment_point` (fixed in the world, [m]). Results of steps do not change. A clone continues to measure, a loaded
    /// world does not.
    void measure_forces(bool on, const Vec3& moment_point = Vec3::Zero());
    bool measures_forces() const;
    /// Forces over the last call of advance. Throws SceneError if forces are not measured.
    Forces forces() const;
    /// Hash of everything that the next step depends on; equal on any number of threads and on every backend.
    std::uint64_t state_hash() const;
    /// From now on calls `take` with the contact problem of every step that has contacts and whose number is a multiple
    /// of `every`, after the step, on the thread that advances. Such a step copies the velocities. An empty function
    /// ends the calls.
    void watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every = 1);
    /// Starts or stops recording the activity of every worker.
    void set_tracing(bool on);
    /// Writes the recorded trace in the Trace Event Format, which Perfetto and chrome://tracing open.
    void write_trace(std::ostream& out) const;
    /// The stages of the step and their dependencies as Graphviz dot text.
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
