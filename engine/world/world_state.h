// Everything a world owns. Only engine/ sees all tables; systems get spans of them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/collider_table.h"
#include "components/contact_table.h"
#include "components/element_table.h"
#include "components/handle.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/pair_table.h"
#include "components/ragged.h"
#include "components/region_table.h"
#include "components/surface_table.h"
#include "engine/world/balance.h"
#include "jobs/executor.h"
#include "jobs/task_graph.h"
#include "jobs/trace.h"
#include "skerry/world.h"
#include "systems/collision/collision_inputs.h"
#include "systems/contact/measure_contacts.h"
#include "systems/contact/separate_regions.h"
#include "systems/dynamics/check_state.h"
#include "systems/dynamics/compute_element_forces.h"
#include "systems/dynamics/find_inversions.h"
#include "systems/dynamics/measure_work.h"
#include "systems/dynamics/move_colliders.h"
#include "systems/dynamics/update_sleep.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// Slot of an attachment that belongs to a mesh collider: no user has a handle to it.
inline constexpr std::uint32_t no_slot = 0xffffffffu;

/// Where the world stands between two moments at which all levels have had their impulses (plan_step.cpp).
struct StepCycle {
    int levels = 0;                                          // the cycle has 2^levels steps
    int index = 0;                                           // steps taken of it
    Real h = 0;                                              // s, of its steps, if none had to be shortened
    std::array<Real, step_level_count> lead{};               // s, by which the impulses of a level are ahead of time; between cycles zero
    std::array<std::uint64_t, step_level_count> elements{};  // of each level in this cycle
};

/// What the stages of one step hand to each other beside the tables.
struct StepState {
    Real time = 0;    // s, start of the step
    Real h = 0;       // s
    Real offset = 0;  // s, by which positions are ahead of velocities; only leapfrog, and only within advance
    StepCycle cycle;
    DueLevels due;
    Vec3 gravity = Vec3::Zero();  // m/s^2
    ContactRegions contact_regions = ContactRegions::separate;
    CollisionSettings collision;
    SolverSettings solver;
    Real max_strain_step = 0;
    StepVerdict verdict;
    Inversions inversions;
    bool let_invert = false;  // the last of the tries to avoid it
    Index crossings = 0;      // features that would go through each other: not zero, and the step is tried again
    ContactMeasures measures;
    ExternalWork external;
    SleepSettings sleep;
    TakenByRest rest;
    Real awake_mass = 0;  // kg, at the start of the step
    Real damped = 0;      // J, taken out by damping in this step

    bool inverts() const { return inversions.first && !let_invert; }
    bool taken() const { return verdict.fault == StepFault::none && crossings == 0 && !inverts(); }
};

/// Sums over all steps since the world was made.
struct RunCounters {
    std::uint64_t steps = 0, inline_steps = 0, shortened = 0, retried = 0, limited = 0, inversions = 0;
    std::uint64_t contacts = 0, regions = 0, iterations = 0, unconverged = 0, certified = 0, closed_form = 0;
    std::uint64_t separating = 0, frictionless = 0, in_lanes = 0, frozen = 0, contact_steps = 0, swept = 0;
    std::uint64_t element_steps = 0, element_impulses = 0;
    Index max_contacts = 0, max_regions = 0, largest_region = 0, worst_region = 0;
    Real worst_error = 0, dissipated = 0, max_penetration = 0, max_gap_violation = 0;
};

/// What only a person or a file reads of a body.
struct BodyRecord {
    std::string name;
    std::vector<std::array<Index, 4>> tetrahedra;  // local nodes
    std::vector<std::array<Index, 3>> surface;     // local nodes
    std::vector<Index> element_order;              // which tetrahedron element e of the body is; empty: number e
};

struct ColliderRecord {
    std::string name;
    Shape shape;
};

/// Node velocities that a step overwrites and its contact problem is made of.
struct KeptVelocities {
    Column<Vec3> velocity;       // m/s, at the start of the step
    Column<Vec3> velocity_next;  // m/s, predicted
};

/// State at the start of a call of advance, while leapfrog has drifted away from it.
struct KeptStart {
    Real time = 0;          // s
    Column<Vec3> position;  // m
    Column<Vec3> velocity;  // m/s
};

/// Who wants to see contact problems. Idle, it costs a skipped stage.
struct ProblemWatch {
    std::function<void(const StepProblem&)> take;
    std::uint64_t every = 1;

    bool wants(std::uint64_t step) const { return take && step % every == 0; }
};

struct WorldState {
    explicit WorldState(const Settings& settings);

    Settings settings;

    NodeTable nodes;
    NodeBlockTable node_blocks;
    ElementBlockTable elements;
    Ragged<Index> corners;  // by node: 4 element + corner
    SurfaceTables surface;
    BvhTable bvh;
    BvhLeafTable bvh_leaves;
    BodyTable bodies;
    MaterialTable materials;
    ColliderTable colliders;
    AttachmentTable attachments;
    HandleMap<MaterialHandle> material_map;
    HandleMap<BodyHandle> body_map;
    HandleMap<ColliderHandle> collider_map;
    HandleMap<AttachmentHandle> attachment_map;
    std::vector<BodyRecord> body_records;          // by row
    std::vector<ColliderRecord> collider_records;  // by row

    PairTable pairs;
    SearchState search;
    CrossingTable crossings;
    ContactTable contacts;
    WarmStartTable warm_start;
    RegionTable regions;
    UnionFind union_find;
    SolverMemory solver_memory;

    StepState step;
    RunCounters counters;
    std::unique_ptr<Executor> executor;
    TaskGraph graph;
    Trace trace;
    bool tracing = false;

    ProblemWatch problem_watch;
    KeptVelocities kept_velocities;
    KeptStart start;
    Column<Real> speed_before;           // m/s, bodies.max_speed: put back when a step is not committed
    Column<Vec3> velocity_before_drive;  // m/s, of attachments.node: put back when a step is not committed
    Column<Real> stiffness_sum;          // scratch of stable_step
    SleepMemory sleep_memory;
    Column<std::uint8_t> pressed;           // by body at rest, in this step
    WarmStartTable warm_start_next;         // scratch of store_warm_start
    bool any_asleep = false;                // some body rests
    Column<ExternalWork> work_parts;        // scratch of measure_work
    Column<InversionPart> inversion_parts;  // and of find_inversions
    std::uint64_t steps_since_watch = 0;
    Balance balance;
    Column<Real> body_mass;                     // kg, of all nodes of a body, held ones, too
    bool loaded = false;                        // some node has a load
    mutable std::vector<Contact> contact_view;  // what contacts() shows
    mutable bool contact_view_is_current = false;

    Index row(BodyHandle body, const char* call) const;
    Index row(ColliderHandle collider, const char* call) const;
    Index row(MaterialHandle material, const char* call) const;
    Index row(AttachmentHandle attachment, const char* call) const;

    ElementInputs element_inputs() const;
    /// Nothing while no body rests: then the stages do not ask node by node.
    RestingNodes resting_nodes() const;
    std::span<const std::uint8_t> resting_bodies() const { return resting_nodes().body_asleep; }
    /// Nothing while no node has a load.
    std::span<const Vec3> loads() const { return loaded ? nodes.load.span() : std::span<const Vec3>(); }
    /// Nothing in a step whose contacts push nothing out.
    std::span<Vec3> pushes() { return solver_memory.pushed() ? nodes.push_out.span() : std::span<Vec3>(); }
    TouchInputs touches() const;
    /// Contacts as the solver sees them; `velocity`: of the nodes at the start of the step.
    RegionInputs region_inputs(std::span<const Vec3> velocity) const;
    /// Ends the rest of one body, or of all.
    void wake(std::size_t body);
    void wake_all();
    /// Before a step: which bodies are in it.
    void note_rest();
    /// Forgets what the search believes of distances.
    void search_afresh();
    /// After bodies or colliders came or went: what is derived from all of them.
    void topology_changed();
};

// build_step.cpp
/// Lists the stages of the step; the graph takes its edges from what they read and write.
void build_step(WorldState& world);

// take_step.cpp
/// Takes one step of length h, or changes nothing and says why in world.step.verdict.
void take_step(WorldState& world, Real h);
/// The largest step that the stiffest body stands, as last watched, and which body (row) that is.
Real stable_step(const WorldState& world, Index* body = nullptr);
/// The longest step that is taken: that of the settings, or the stable step where that is shorter.
Real trusted_step(const WorldState& world, Index* body = nullptr);
/// Looks at the stable step of every body again.
void watch_stable_step(WorldState& world);

/// Colliders have moved for so long at their present motion. Bodies have their travel from measure_drift.
void add_collider_travel(WorldState& world, Real seconds);

// plan_step.cpp
struct StepPlan {
    Real h = 0;       // s
    Real steps = 1;   // of this length to the end of what was asked for
    Real stable = 0;  // s, the longest step that stability or the settings allow
};
/// The next step of a call that has `left` seconds to go, where no step may be longer than `fast_limit`. Begins a cycle between two.
StepPlan plan_step(WorldState& world, Real left, Real fast_limit);
/// Writes world.step.due for the step of length world.step.h, and which levels of each body that means.
void find_due_levels(WorldState& world);
/// After a committed step: what its impulses covered.
void count_impulses(WorldState& world);

// drift_state.cpp
/// Lets positions, colliders and attachments drift until they are `offset` seconds ahead of the velocities.
void drift_to(WorldState& world, Real offset);
/// Keeps the state that a call of advance starts from, where a drift would change it, and puts it back when no step could be committed.
void keep_start(WorldState& world);
void put_back_start(WorldState& world);

// watch_problems.cpp
/// Copies what the contact problem of this step is made of.
void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, KeptVelocities& kept);
/// Hands over the contact problem of the step just taken, if somebody wants it.
void show_contact_problem(const WorldState& world, Real time);

// edit_bodies.cpp
/// Appends a surface with or without tetrahedra as a body; returns its row.
struct NewBody {
    std::uint32_t slot = 0;
    BodyKind kind = BodyKind::deformable;
    bool self_contact = false;
    Index material = no_index;
    Index collider = no_index;
    Real contact_distance = -1;  // m, < 0: 2 % of the mean edge
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // of a surface without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;
};
Index append_body(WorldState& world, const NewBody& body);
void erase_body(WorldState& world, Index row);

// edit_colliders.cpp
Index append_attachment(WorldState& world, std::uint32_t slot, Index body, std::span<const Index> nodes, const RigidPose& pose,
                        const Motion& motion);
void erase_attachment(WorldState& world, Index row);
Index append_collider(WorldState& world, std::uint32_t slot, const Shape& shape, const ColliderSettings& settings);
void erase_collider(WorldState& world, Index row);

// validate.cpp
void validate(const Settings& settings);
void validate(const MaterialSettings& material, const Settings& settings);
void validate(const Mesh& mesh, const BodySettings& body);
void validate(const Shape& shape, const ColliderSettings& collider);
void validate(const Motion& motion, const std::string& object);
void validate(const Motion& motion, const Vec3& pivot);

// world_report.cpp
Energy energy_of(const WorldState& world);

/// An element, by row of the table, by its number in the mesh that the user gave.
Index user_element(const WorldState& world, std::size_t body, Index element);
std::uint64_t hash_of(WorldState& world);

}  // namespace skerry
