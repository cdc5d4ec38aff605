// The world: deformable bodies, colliders and attachments, and the functions that advance it in time.
#pragma once

#include <cstddef>
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
struct WorldState;  // internal type, declared outside the pragma that exports symbols
}

#pragma GCC visibility push(default)
namespace skerry {

struct StepProblem;  // defined in problem.h

/// Settings of a loaded world or of a clone. They do not change the results of steps. A missing value is taken from the
/// saved or cloned world. If this build does not have the backend of that world, Backend::automatic is used.
struct LoadSettings {
    std::optional<Backend> backend{};  // library that manages the threads
    std::optional<int> threads{};      // number of threads, >= 0; a world with one thread starts no other thread
};

/// A simulation. A world must not be used by several threads at once, not even for reading. Different worlds are
/// independent. Functions throw SceneError if a handle is stale or belongs to another world, if a setting is out of
/// range, or if the world was moved from.
class World {
public:
    /// Makes an empty world.
    explicit World(const Settings& settings = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // Copies and files; allowed between calls of advance (docs/save_restore.md). A copy continues exactly like this
    // world, bit by bit, on any number of threads.
    // - Handles of this world name the same objects in the copy.
    // - The report() of the copy covers the whole run, including the steps of this world.
    // - The copy does not get the functions of watch_steps() and watch_contact_problems(), recorded traces, and the
    //   computing times of stages.
    /// Returns a copy of this world.
    World clone(const LoadSettings& settings = {}) const;
    /// Saves the world. The file is written under another name and then renamed, so an existing file is replaced
    /// completely or not at all. If writing fails, throws SceneError that names the cause; the world is unchanged.
    void save(const std::filesystem::path& file) const;
    /// Reads a world that save() wrote. Throws SceneError if the file cannot be read or a value in it is invalid; the
    /// error names the file, the data set, and the found and the expected value.
    static World load(const std::filesystem::path& file, const LoadSettings& settings = {});
    /// Returns the bytes that save() writes.
    std::vector<std::byte> to_bytes() const;
    /// Makes a world from bytes of to_bytes() or of a saved file.
    static World from_bytes(std::span<const std::byte> bytes, const LoadSettings& settings = {});

    // Building the world; allowed between calls of advance. In callbacks of advance these functions throw SceneError.
    // - Removing an object keeps the handles of all other objects valid.
    // - The cost of a change depends on the size of the changed object only. Consecutive removals are carried out
    //   together, at the next call that uses the remaining objects.
    /// Adds a material, which bodies name in BodySettings::material.
    MaterialHandle add_material(const MaterialSettings& material);
    /// Adds a body from a mesh of tetrahedra. The mesh is copied. Overlaps are found later, by settle_start().
    BodyHandle add_body(const Mesh& mesh, const BodySettings& body);
    /// Adds a rigid body from the triangles of its surface; `body.dynamics` must be rigid. The surface consists of one
    /// or several closed shells, for example one for each convex part of a robot link. A shell that is inside out
    /// bounds a void.
    ///
    /// Shells may cross each other only if mass, centre of mass and inertia are given, because a volume in which shells
    /// overlap would count twice.
    BodyHandle add_body(const SurfaceMesh& surface, const BodySettings& body);
    /// Adds a rigid sphere. Contacts and queries use the exact sphere. Its nodes, faces and tetrahedra are for output
    /// only (mesh::sphere_picture), and the first node is the centre. `body.dynamics` must be rigid or automatic, and
    /// the sphere is rigid. It cannot be attached or become another kind of body.
    BodyHandle add_body(const Sphere& sphere, const BodySettings& body);
    /// Adds a rigid capsule. The rules for a sphere apply, see add_body() above. The axis is z of the capsule's frame,
    /// and the first two nodes are the ends of the axis (mesh::capsule_picture). `capsule.length` must be > 0.
    BodyHandle add_body(const Capsule& capsule, const BodySettings& body);
    /// Adds a rigid cylinder with flat ends and sharp rims. The rules for a sphere apply, see add_body() above. The
    /// axis is z of the cylinder's frame, and the first node is the centre (mesh::cylinder_picture).
    BodyHandle add_body(const Cylinder& cylinder, const BodySettings& body);
    /// Adds a collider: a rigid shape that does not move or moves as prescribed, whatever forces act on it. A collider
    /// has no mass. It touches bodies, and no other collider.
    ColliderHandle add_collider(const Shape& shape, const ColliderSettings& collider = {});
    /// Prescribes the motion of some nodes of a body (numbers within the body). From now on the nodes stay in place or
    /// follow `motion`:
    /// - A constant angular velocity rotates the nodes about the point `pivot` [m].
    /// - Keys of a motion are poses of a frame at absolute times. The nodes move rigidly with this frame, beginning at
    ///   its pose at the present time.
    /// For a rigid or implicit body at least three nodes that are not on one line are required. They hold the whole
    /// rigid body, or the frame of the implicit body: the rigid motion without its deformation. A body that `automatic`
    /// made implicit first becomes explicit, as by set_dynamics().
    ///
    /// `directions`: the nodes are held along these directions only, and are free normal to them (a roller support;
    /// docs/methods/sets_and_rollers.md 2). Empty: the nodes are held completely.
    /// - Directions are fixed in the world, of any nonzero length, and perpendicular to each other. They are only for
    ///   explicit bodies, and for velocities or keys without rotation.
    /// - Several attachments can hold a node if their directions are perpendicular or equal. Along equal directions the
    ///   node follows the last attachment.
    /// - The contact solver satisfies held directions and contacts together. Exception: a contact whose normal lies
    ///   exactly along a held direction treats the node as free, so its impulse is too small to stop the other object.
    ///   Hold nodes completely where objects press on them in this way.
    AttachmentHandle attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion = {},
                            const Vec3& pivot = Vec3::Zero(), const std::vector<Vec3>& directions = {});
    /// Removes an object, and with it the joints, ties and other objects that name it.
    void remove(BodyHandle body);
    void remove(ColliderHandle collider);
    void remove(AttachmentHandle attachment);
    /// True if the object is in this world, false if it was removed. Throws no error for a stale handle.
    bool alive(BodyHandle body) const;
    bool alive(ColliderHandle collider) const;
    bool alive(AttachmentHandle attachment) const;

    // Running the simulation.

    /// Finds overlaps of bodies and colliders that were added or moved by the user since the last check, and treats
    /// them according to Settings::start_overlaps. If they are refused, throws SceneError and changes nothing.
    ///
    /// Every call of advance() begins with this check. Call settle_start() earlier to get the result
    /// (WorldReport::start_overlaps) before the first step.
    void settle_start();
    /// Advances time by dt >= 0 [s], in equal steps no longer than the stable step. A step that cannot be committed
    /// changes nothing and ends the call; the report names the body and the reason. Throws SceneError if dt is
    /// negative, not finite or longer than 2147483647 steps. Throws the errors of settle_start(), too.
    StepReport advance(Real dt);
    /// Advances like advance(dt), but calls `go_on` with the report so far before each attempt at a step. If `go_on`
    /// returns false, the call ends between two steps. The report then has the status `stopped`, and the world can be
    /// advanced further.
    StepReport advance(Real dt, const std::function<bool(const StepReport&)>& go_on);
    /// From now on calls `observe` after every committed step, with the report so far, on the thread that advances.
    /// Pass an empty function to end the calls.
    ///
    /// `observe` may read the whole state, but must not change the world. With the integrator leapfrog, the positions
    /// that it reads are half a step ahead of the velocities. If it throws an exception, the call of advance ends
    /// between two steps and rethrows it.
    void watch_steps(std::function<void(const StepReport&)> observe);
    /// Simulated time since the world was made [s].
    Real time() const;
    /// Settings of this world, with the gravity of set_gravity().
    const Settings& settings() const;
    /// Stable step of the stiffest body [s], an upper limit of the steps of advance(). If all bodies are rigid or
    /// implicit: the step length that advance() uses.
    Real stable_step() const;

    // State of a body. The spans are valid until bodies are added or removed, set_dynamics() changes a body, or
    // reset(saved) is called. advance() changes the positions and velocities in the spans.
    std::span<const Vec3> positions(BodyHandle body) const;                   // positions of the nodes [m]
    std::span<const Vec3> velocities(BodyHandle body) const;                  // velocities of the nodes [m/s]
    std::span<const std::array<Index, 3>> surface(BodyHandle body) const;     // node numbers of boundary triangles
    std::span<const std::array<Index, 4>> tetrahedra(BodyHandle body) const;  // node numbers of tetrahedra
    /// Cauchy stress and Green strain of a body, by tetrahedron or by node. The stress is that of the material law
    /// alone, without the viscous stress (`loss_factor`, `bulk_viscosity`).
    /// - Tetrahedron: the mean over the finite elements that cover it.
    /// - Node: recovered from the elements around the node, and from the traction on the surface
    ///   (docs/methods/elasticity.md 7.9). At an interface of two materials, where the stress jumps, it is the mean of
    ///   both sides.
    std::vector<Mat3> stress(BodyHandle body) const;       // Cauchy stress by tetrahedron [Pa]
    std::vector<Mat3> strain(BodyHandle body) const;       // Green strain by tetrahedron
    std::vector<Mat3> node_stress(BodyHandle body) const;  // Cauchy stress by node [Pa]
    std::vector<Mat3> node_strain(BodyHandle body) const;  // Green strain by node
    /// Stress at the given nodes, in the given order, computed from the elements around these nodes only. The values
    /// are bitwise those of node_stress(body). Throws SceneError if the body has no such node.
    std::vector<Mat3> node_stress(BodyHandle body, std::span<const Index> nodes) const;
    /// Equivalent plastic strain, by tetrahedron. For a material that yields, strain() and node_strain() return the
    /// elastic strain.
    std::vector<Real> plastic_strain(BodyHandle body) const;
    std::vector<Real> von_mises_stress(BodyHandle body) const;         // von Mises stress by tetrahedron [Pa]
    std::vector<Real> node_von_mises_stress(BodyHandle body) const;    // von Mises stress by node [Pa]
    std::vector<Vec3> node_principal_stresses(BodyHandle body) const;  // three by node, the largest first [Pa]
    /// Longest step that each tetrahedron allows in the present shape of the body [s]: the stable step of the stiffest
    /// element that covers the tetrahedron. To lengthen the stable step of a body, repair its tetrahedra with the
    /// shortest steps.
    ///
    /// The shortest of these steps is the stable step of an undeformed body. The stable step of a strained body can be
    /// longer: elements at the same node share its mass, and less stiff elements can leave more of it to a stiff one.
    std::vector<Real> tetrahedron_steps(BodyHandle body) const;
    /// Name of a body (BodySettings::name).
    const std::string& name(BodyHandle body) const;
    /// Returns the kind of the elements of a body. For a body added as `smoothed` this is the kind that was chosen, or
    /// edge_node_smoothed if the choice differs between materials of the body.
    ElementKind element(BodyHandle body) const;
    /// Present kind of a body. For a body added with `automatic` it is the kind that was chosen.
    BodyDynamics dynamics(BodyHandle body) const;
    /// For a body added with `automatic`: the cost estimate behind the choice. For all other bodies `reason` is
    /// `given`.
    DynamicsEstimate dynamics_choice(BodyHandle body) const;
    /// Present pose of the frame of the body's mesh; initially the pose in BodySettings. For a deformed body it is the
    /// pose in which the undeformed mesh fits best: it has the centre of mass and the mean rotation of the body.
    MotionKey pose(BodyHandle body) const;
    Real mass(BodyHandle body) const;              // mass of all nodes [kg]
    Vec3 center_of_mass(BodyHandle body) const;    // present centre of mass [m]
    Real contact_distance(BodyHandle body) const;  // BodySettings::contact_distance, or its default [m]
    bool asleep(BodyHandle body) const;            // true if the body is asleep, see Settings::sleep
    void wake(BodyHandle body);              // wakes a sleeping body; bodies that touch this body wake in later steps
    Real mean_edge(BodyHandle body) const;   // mean edge length of the surface of a body in its rest shape [m]
    std::vector<BodyHandle> bodies() const;  // in the order added; after set_dynamics() a body counts as added last
    std::vector<ColliderHandle> colliders() const;  // all colliders, in the order added
    /// Present pose of a collider: position and rotation vector (axis times angle). For a plane it is the point of the
    /// plane and a rotation that takes +z to its normal.
    MotionKey pose(ColliderHandle collider) const;
    /// Present pose of the moving frame to which the nodes are attached. At the time of attaching, this frame was at
    /// the pivot without rotation, or at the pose of the keys.
    MotionKey pose(AttachmentHandle attachment) const;
    /// Shape of a collider in its own frame.
    const Shape& shape(ColliderHandle collider) const;
    const std::string& name(ColliderHandle collider) const;       // name in messages and output
    std::vector<AttachmentHandle> attachments() const;            // handles in the order added
    BodyHandle body(AttachmentHandle attachment) const;           // body of the attached nodes
    std::vector<Index> nodes(AttachmentHandle attachment) const;  // numbers of the attached nodes within the body
    // unit vectors along which the nodes are held; empty if they are held completely
    std::vector<Vec3> directions(AttachmentHandle attachment) const;
    /// Velocities of a rigid motion. For a body: the rigid motion that has the momentum and the angular momentum of the
    /// body. For a collider or an attachment: its motion in the last step.
    Twist velocity(BodyHandle body) const;
    Twist velocity(ColliderHandle collider) const;
    Twist velocity(AttachmentHandle attachment) const;

    // Live control (docs/control.md); allowed between calls of advance. In callbacks of advance these functions throw
    // SceneError.
    // - A change updates only the changed object, so its cost does not depend on the size of the world.
    // - Setting an equal value again changes no bit of the state.
    // - A refused value changes nothing, and the SceneError names it.
    /// Sets the acceleration of gravity [m/s^2]. Sleeping bodies wake.
    void set_gravity(const Vec3& gravity);
    /// Sets the velocities at which a collider, or the nodes of an attachment, move from now on [m/s, rad/s about
    /// Pose::position]. They apply until the motion is set again. Earlier keys and targets are dropped.
    void set_velocity(ColliderHandle collider, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    void set_velocity(AttachmentHandle attachment, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// Moves a collider or an attachment to a pose at constant velocities. It reaches the pose after `duration` (> 0
    /// [s]) of simulated time, at the end of advance(duration), and then stops. Of the two rotations that lead to the
    /// pose, the motion uses the smaller one.
    void move_to(ColliderHandle collider, const Pose& pose, Real duration);
    void move_to(AttachmentHandle attachment, const Pose& pose, Real duration);
    /// Puts a collider or an attachment at another pose at once. Objects on the way are neither pushed nor detected.
    /// Settings::start_overlaps applies to new overlaps. Constant velocities continue from the new pose; keys of a
    /// motion and targets of move_to() are dropped.
    ///
    /// Only the attached nodes jump, so an explicit body is deformed; throws SceneError if an element would be
    /// inverted. If the attachment holds a rigid body or the frame of an implicit body, the whole body moves.
    void set_pose(ColliderHandle collider, const Pose& pose);
    void set_pose(AttachmentHandle attachment, const Pose& pose);
    /// Sets the positions of all nodes of a body, one vector per node [m, world frame]. Velocities do not change, and
    /// attached nodes are held at their new positions. Settings::start_overlaps applies to new overlaps. Throws
    /// SceneError if an element would be inverted, or if a rigid body would be deformed.
    void set_positions(BodyHandle body, std::span<const Vec3> position);
    /// Sets the velocities of all nodes of a body, one vector per node [m/s]. A rigid body gets the rigid motion that
    /// is nearest to these velocities.
    void set_velocities(BodyHandle body, std::span<const Vec3> velocity);
    /// Moves a body in its present shape to another pose.
    void set_pose(BodyHandle body, const Pose& pose);
    /// Gives all nodes the velocities of a rigid motion about the centre of mass [m/s, rad/s].
    void set_velocity(BodyHandle body, const Vec3& velocity, const Vec3& angular_velocity = Vec3::Zero());
    /// Changes the kind of a body. Handle, name, settings and shape stay, and the body counts as added last. Centre of
    /// mass, momentum and angular momentum stay the same up to rounding.
    /// - Between explicit and implicit: the velocities of all nodes stay, too.
    /// - To rigid: the body is frozen in its present shape; its vibration is lost. When it becomes explicit or implicit
    ///   again, its rest shape is still that of its mesh.
    /// - To explicit: viscous stress starts fully relaxed, as if the body had been in its shape for a long time.
    /// Throws SceneError for `automatic`, and for a body
    /// - that is attached, has a joint or a given mass, has no tetrahedra, is a sphere, capsule or cylinder, or has
    ///   deformed plastically,
    /// - with self-contact, if it is to become rigid or implicit,
    /// - with a set loss factor or plasticity, if it is to become implicit,
    /// - with inverted tetrahedra, if it is to become rigid.
    void set_dynamics(BodyHandle body, BodyDynamics dynamics);
    /// Puts a body back into its rest shape, without velocity, at the pose of its BodySettings or at the given pose of
    /// its mesh. A rigid body keeps its shape, even a deformed one in which set_dynamics() froze it.
    ///
    /// Plastic flow, viscous strains, sleep, and the stored impulses of its contacts and joints are reset. Attached
    /// nodes are held at their new positions; loads stay. Settings::start_overlaps applies to new overlaps.
    void reset(BodyHandle body);
    void reset(BodyHandle body, const Pose& pose);
    /// Resets all bodies to the poses of their BodySettings. Time, colliders, attachments and loads do not change.
    void reset();
    /// Continues from the state of `saved`, which must be a clone() of this world. Threads and callbacks of this world
    /// stay. From now on forces are measured if and only if `saved` measures forces.
    ///
    /// - Handles of objects that `saved` has stay valid.
    /// - Handles of objects that were added to this world after the cloning become stale. If objects were added to
    ///   `saved` as well, such a handle may name one of these by mistake.
    void reset(const World& saved);
    /// Sets the external forces on all nodes of a body, one vector per node [N]. They act until they are set again.
    void set_loads(BodyHandle body, std::span<const Vec3> load);
    std::span<const Vec3> loads(BodyHandle body) const;  // external forces on the nodes [N]
    /// Returns the present settings of a material.
    MaterialSettings material(MaterialHandle material) const;
    /// Replaces the settings of a material. Bodies of this material keep their shapes and velocities and get new
    /// masses, stable steps and clusters. Elements added as `smoothed` keep the kind that Poisson's ratio determined
    /// when their body was added. Throws SceneError
    /// - if the material model would change, or plasticity would appear or vanish,
    /// - if a body of this material would have no stable step,
    /// - if an implicit body would get a loss factor above 0,
    /// - if elastic values, density or losses would change, and a body of this material has deformed plastically.
    void set_material(MaterialHandle material, const MaterialSettings& settings);
    std::vector<MaterialHandle> materials() const;   // handles in the order added
    MaterialHandle material(BodyHandle body) const;  // BodySettings::material
    /// Friction and restitution that were set for a body or collider itself, and not only for its material. Values that
    /// were not set are empty.
    SurfaceSettings surface_properties(BodyHandle body) const;
    SurfaceSettings surface_properties(ColliderHandle collider) const;
    /// Replaces the surface properties that were set for an object. See SurfaceSettings for missing values.
    void set_surface_properties(BodyHandle body, const SurfaceSettings& surface);
    void set_surface_properties(ColliderHandle collider, const SurfaceSettings& surface);
    /// Groups of an object, and groups with which it can collide (see BodySettings::collision_group).
    CollisionGroups collision_groups(BodyHandle body) const;
    CollisionGroups collision_groups(ColliderHandle collider) const;
    /// Sets the groups of an object, and the groups with which it collides.
    void set_collision_groups(BodyHandle body, std::uint32_t group, std::uint32_t mask);
    void set_collision_groups(ColliderHandle collider, std::uint32_t group, std::uint32_t mask);
    /// Switches the collision of a pair of objects on or off. Initially it is on for all pairs that the collision
    /// groups admit. If `a` and `b` are one body, sets its self-contact (BodySettings::self_contact).
    /// Settings::start_overlaps applies to a pair that is switched on.
    void set_collision(BodyHandle a, BodyHandle b, bool on);
    void set_collision(BodyHandle body, ColliderHandle collider, bool on);
    /// True if the collision groups and the settings of set_collision() allow the two objects to collide.
    bool may_collide(BodyHandle a, BodyHandle b) const;
    bool may_collide(BodyHandle body, ColliderHandle collider) const;

    // Queries of the present surfaces. The first query after a step refits the bounding volume trees of the bodies that
    // the query tests.

    /// Finds the first surface hit by a ray from `origin` [m] along `direction` (any length but zero) within
    /// `max_distance` [m], from either side; empty if there is none. Among equally near surfaces, bodies come before
    /// colliders, each in the order added.
    std::optional<SurfaceHit> cast_ray(const Vec3& origin, const Vec3& direction, Real max_distance,
                                       const QueryFilter& filter = {}) const;
    /// Finds the nearest point of any surface within `max_distance` [m] of the given point, which may be inside or
    /// outside of objects. Returns nothing if there is no such surface.
    std::optional<SurfaceHit> nearest_point(const Vec3& point, Real max_distance, const QueryFilter& filter = {}) const;

    // Results.

    /// Contacts of the last step and contacts between sleeping bodies, in a fixed order. Contacts of objects that were
    /// removed since are omitted. Empty if the last step was refused.
    std::span<const Contact> contacts() const;
    /// Counters of the run, and values of the present state such as momentum and energy. Each call computes these
    /// values from all bodies and elements, which takes time.
    WorldReport report() const;
    /// Kinetic, elastic and potential energy of all bodies now, and the energy dissipated since the start [J].
    Energy energy() const;
    /// Switches the measurement of forces on or off. While it is on, each call of advance sums the forces of contacts
    /// and attachments, with moments about `moment_point` (fixed in the world, [m]). Results of steps do not change. A
    /// clone continues to measure, a loaded world does not.
    void measure_forces(bool on, const Vec3& moment_point = Vec3::Zero());
    /// True while forces are measured.
    bool measures_forces() const;
    /// Forces over the last call of advance. Throws SceneError if forces are not measured.
    Forces forces() const;
    /// Hash of all data on which the next step depends. It is equal on any number of threads and on every backend.
    std::uint64_t state_hash() const;
    /// From now on calls `take` with the contact problem of every step that has contacts and whose number is a multiple
    /// of `every`. The call comes after the step, on the thread that advances. Each such step keeps copies of the
    /// velocities, which takes some time. Pass an empty function to end the calls.
    void watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every = 1);
    /// Starts or stops recording a trace: the time intervals in which each worker thread runs the stages of a step.
    void set_tracing(bool on);
    /// Writes the recorded trace in the Trace Event Format, which Perfetto and chrome://tracing open.
    void write_trace(std::ostream& out) const;
    /// The stages of the step and their dependencies as text in the dot language of Graphviz.
    std::string step_graph() const;

private:
    friend struct WorldAccess;
    /// Pointer to the state of the world. Access throws SceneError if the world was moved from.
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
