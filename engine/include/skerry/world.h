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

#include "skerry/error.h"
#include "skerry/mesh.h"
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
    // else stay valid. What is derived of all bodies is made anew when it is next asked for: adding many costs no more
    // than adding each.
    MaterialHandle add_material(const MaterialSettings& material);
    BodyHandle add_body(const Mesh& mesh, const BodySettings& body);
    ColliderHandle add_collider(const Shape& shape, const ColliderSettings& collider = {});
    /// Takes the freedom of nodes (local numbers) of a body: they stay where they are, or follow the motion from now
    /// on. Constant velocities turn them about `pivot`; keys are poses at absolute times, and the nodes are attached to
    /// the pose that the keys have now.
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
    Real time() const;
    const Settings& settings() const;
    void set_gravity(const Vec3& gravity);
    /// The step that advance would take at most, s.
    Real stable_step() const;

    // State of a body. Spans stay valid until bodies are added or removed; positions and velocities also change with
    // advance.
    std::span<const Vec3> positions(BodyHandle body) const;   // m
    std::span<const Vec3> velocities(BodyHandle body) const;  // m/s
    void set_velocities(BodyHandle body, std::span<const Vec3> velocity);
    /// External forces on the nodes, kept until set again, N.
    void set_loads(BodyHandle body, std::span<const Vec3> load);
    std::span<const std::array<Index, 3>> surface(BodyHandle body) const;     // boundary triangles, local nodes
    std::span<const std::array<Index, 4>> tetrahedra(BodyHandle body) const;  // local nodes
    /// Cauchy stress, Pa, without what relaxes (losses), and Green's strain. A tetrahedron has the mean of the elements
    /// that cover it, a node the mean of its tetrahedra by volume (docs/methods/elasticity.md 7.5), whatever their
    /// materials: where two meet stress jumps, and the nodes between them have a mean of both sides.
    std::vector<Mat3> stress(BodyHandle body) const;            // by tetrahedron
    std::vector<Mat3> strain(BodyHandle body) const;            // by tetrahedron
    std::vector<Mat3> node_stress(BodyHandle body) const;       // by node
    std::vector<Mat3> node_strain(BodyHandle body) const;       // by node
    std::vector<Real> von_mises_stress(BodyHandle body) const;  // Pa, by tetrahedron
    /// The step that each tetrahedron allows as the body is now, s: that of the stiffest element that covers it. The
    /// shortest is the body's stable step, the tetrahedra that have it are those to mend.
    std::vector<Real> tetrahedron_steps(BodyHandle body) const;
    const std::string& name(BodyHandle body) const;
    /// What it has. `smoothed` is told as what it stands for: where that differs by material, as edge_node_smoothed.
    ElementKind element(BodyHandle body) const;
    Real mass(BodyHandle body) const;              // kg
    Vec3 center_of_mass(BodyHandle body) const;    // m
    Real contact_distance(BodyHandle body) const;  // m
    bool asleep(BodyHandle body) const;            // at rest, see Settings::sleep_speed
    void wake(BodyHandle body);                    // ends its rest; what it touches wakes within steps
    Real mean_edge(BodyHandle body) const;         // m, of the rest surface
    std::vector<BodyHandle> bodies() const;        // in the order added
    std::vector<ColliderHandle> colliders() const;
    /// Pose of a collider now: position and rotation (axis times angle).
    MotionKey pose(ColliderHandle collider) const;
    const Shape& shape(ColliderHandle collider) const;
    const std::string& name(ColliderHandle collider) const;

    // What happened.
    /// Of the last step, in a fixed order, without those of what was removed since; none when the step was refused.
    std::span<const Contact> contacts() const;
    WorldReport report() const;
    Energy energy() const;
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
