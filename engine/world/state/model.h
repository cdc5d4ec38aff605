// The simulated objects in their present state: bodies, colliders, attachments, joints and materials.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/any_table.h"
#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/cable_table.h"
#include "components/cavity_table.h"
#include "components/collider_table.h"
#include "components/collision_filter.h"
#include "components/element_table.h"
#include "components/fibre_table.h"
#include "components/handle.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/load_table.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/ragged.h"
#include "components/range.h"
#include "components/rigid_body_table.h"
#include "components/spring_table.h"
#include "components/step_watch.h"
#include "components/surface_rules.h"
#include "components/surface_table.h"
#include "components/tie_table.h"
#include "engine/world/state/field_cache.h"
#include "engine/world/state/known_elements.h"
#include "engine/world/tuning.h"
#include "skerry/mesh.h"
#include "skerry/settings.h"
#include "skerry/surface.h"
#include "skerry/world.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/kinds/element_list.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

struct BoundVisual;  // engine/mesh/visual/bound_visual.h

/// Entry of a column `slot` for a table row to which no user handle refers, such as the attachment that moves a mesh
/// collider.
inline constexpr std::uint32_t no_slot = 0xffffffffu;

/// Mass properties of a body that its settings give: none, only the mass, or the mass, its centre and the inertia.
enum class GivenMass : std::uint8_t { none, mass, all };
template <>
inline constexpr std::uint64_t value_count<GivenMass> = 3;

/// Data of a body that are not stored in tables. They serve users and files, and table rows are built from them.
struct BodyRecord {
    std::string name;
    ElementKind element;  // kind in use: for `smoothed`, either edge_smoothed or edge_node_smoothed
    ElementKind
        requested_element;  // kind requested by the user; used again when the user changes the dynamics of the body
    std::vector<std::array<Index, 4>> tetrahedra;  // corners: node numbers within the body
    std::vector<std::array<Index, 3>> surface;     // corners: node numbers within the body
    // For each tetrahedron, the row of its material in MaterialTable. If the list is empty, all tetrahedra have the
    // material of the body.
    std::vector<Index> tetrahedron_material;
    std::vector<int> label{};               // Mesh::label
    std::map<std::string, MeshSet> sets{};  // sets by name; nodes and tetrahedra numbered within the body
    // Surface that is drawn in place of the body; nullptr if there is none. Bodies with the same mesh may share it.
    std::shared_ptr<const BoundVisual> visual{};
    // Tetrahedra that each element covers. The elements of a body fill blocks of element_lanes lanes; the list has one
    // entry for each lane, in this order. The entry of an unused lane is empty.
    Ragged<Index> element_tetrahedra;
    bool settled = false;                             // true if settle_start has checked the body for overlaps
    RigidPose start{Vec3::Zero(), Mat3::Identity()};  // pose at which the body was added
    // Rotation that the body had when its elements were built: when the body was added, or when its dynamics last
    // changed. The undeformed elements have this rotation.
    Mat3 built = Mat3::Identity();
    // For a rigid body that is frozen in a deformed shape: node positions of the mesh, in the frame of the mesh [m].
    // NodeTable::rest_position contains the frozen shape. For all other bodies the list is empty.
    std::vector<Vec3> mesh_shape{};
    GivenMass given_mass = GivenMass::none;
    // for a body added with the dynamics `automatic`: the estimate from which the engine has chosen the kind of
    // dynamics
    DynamicsEstimate choice{};
    FieldCache fields{};
};

struct ColliderRecord {
    std::string name;
    Shape shape;
    bool settled = false;  // true if settle_start has checked the collider for overlaps
};

/// Handles of objects, with the names that users have given to some of them. No step depends on a name.
template <class HandleType>
struct NamedHandles : HandleMap<HandleType> {
    std::map<HandleType, std::string> names;
};

/// Properties, over all ranks (processes of a divided world), on which the length of a step depends. reduce_limits
/// computes them. Without ranks the initial values remain, which limit nothing.
///
/// The row of a body in the undivided world is the row of BodyTable that it would have if one process simulated all
/// bodies.
struct LimitsOfRanks {
    Real stable_step = infinity;  // shortest stable step [s]
    Index stiffest = no_index;    // row in the undivided world of the body with this stable step
    bool strained = false;        // true if strain, and not the rest shape, makes this stable step short (is_strained)
    Real rest_step = infinity;    // shortest stable step at rest of a body with elements [s]
    Real spin = 0;                // greatest angular speed of a rigid or implicit body with a joint or tie [rad/s]
    Index spinning = no_index;    // row in the undivided world of the body with this speed
    bool has_frames = false;      // true if some body is rigid or implicit
    bool has_implicit = false;    // true if some body is implicit
    bool has_clusters = false;    // true if some body has clusters (groups of nodes that implicit elements couple)
    bool forced = false;          // true if Model::forced is true on some rank
    // True if forces that depend on motion act on implicit bodies. These then take no long steps, which cover several
    // steps of the world.
    bool follow_implicit = false;
    bool clusters_grew = false;  // true if Model::clusters_grew is true on some rank
    // sums over all ranks: numbers of element blocks and of entries of cluster matrices
    std::uint64_t element_blocks = 0, cluster_entries = 0;
    // True if stable steps depend on positions, or if joints or ties limit the rotation in a step. reduce_limits must
    // then be called before each step.
    bool moves = false;
};

struct Model {
    Settings settings;
    Tuning tuning;
    LimitsOfRanks of_ranks;

    NodeTable nodes;
    NodeBlockTable node_blocks;
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable element_nodes;
    ElementPatches patches;  // computed by extend_derived
    // Groups of nodes that implicit elements couple. They are saved with a world, because they cannot be derived from
    // its other tables: their matrices depend on the steps in which elements have stiffened.
    NodeClusters clusters;
    RigidBodyTable rigid_bodies;
    ImplicitNodeTable implicit_nodes;
    // Matrices of implicit bodies; entry r belongs to the body in row r of rigid_bodies. Computed by derive_all and
    // stiffen.
    StiffBodies stiff_bodies;
    SurfaceTables surface;
    BvhTable bvh;
    BvhLeafTable bvh_leaves;
    BodyTable bodies;
    MaterialTable materials;
    ColliderTable colliders;
    AttachmentTable attachments;
    JointTable joints;
    TieTable ties;
    CableTable cables;
    CavityTable cavities;
    PipeTable pipes;
    FibreTable fibres;
    LoadTable loads;
    SpringTable springs;
    DisabledPairTable disabled_pairs;
    MaterialPairTable material_pairs;
    SurfaceSetTable surface_sets;
    SetOfFeature set_of_feature;  // derived from surface_sets by note_changed_seams
    HandleMap<MaterialHandle> material_map;
    HandleMap<BodyHandle> body_map;
    HandleMap<ColliderHandle> collider_map;
    HandleMap<AttachmentHandle> attachment_map;
    NamedHandles<JointHandle> joint_map;
    NamedHandles<SurfaceSetHandle> surface_set_map;
    NamedHandles<TieHandle> tie_map;
    NamedHandles<CableHandle> cable_map;
    NamedHandles<CavityHandle> cavity_map;
    NamedHandles<PipeHandle> pipe_map;
    NamedHandles<FibreHandle> fibre_map;
    NamedHandles<LoadHandle> load_map;
    NamedHandles<SpringHandle> spring_map;
    StepWatch watch;
    std::vector<BodyRecord> body_records;          // one record for each row of BodyTable
    std::vector<ColliderRecord> collider_records;  // one record for each row of ColliderTable
    std::vector<KnownElements> known_elements;     // elements of meshes that were added since the last call of settle()

    Column<Real> body_mass;  // mass of all nodes of each body, including held nodes [kg]; computed by extend_derived
    // True if settle_clusters must choose the implicit elements again, because bodies, materials or attachments have
    // changed.
    bool clusters_open = true;
    bool clusters_grew = false;  // true if elements became implicit at the last evaluation of stable steps
    bool settled = true;         // true if all bodies and colliders were checked for overlaps
    Index loaded_bodies = 0;     // number of bodies with loads; computed by derive_all and note_loads
    // true if any load or other force element (seams.h) is present; computed by note_forces
    bool forced = false;
    // For each body: upper bound by which all force elements together raise its squared natural frequencies
    // (ForceElement::add_rate) [1/s^2]. If the column is empty, all bounds are zero. Computed by note_forces.
    Column<Real> force_rate;
    // Working memory of add_cavity_rate, for each node of one body. `face_areas`: sum over the faces at the node of a
    // third of the area vector [m^2]. `face_edges`: sum over the same faces of the longest edge [m].
    Column<Vec3> face_areas;
    Column<Real> face_edges;
    // True if `force_rate` depends on positions, so that it must be computed again before each step. Computed by
    // note_forces.
    bool force_rate_moves = false;
    // For each body, over all force elements: the largest damping rate (ForceElement::bound_damping), and the sum of
    // the drag rates (ForceElement::add_drag) [1/s]. If a column is empty, all its values are zero. Computed by
    // note_forces.
    Column<Real> force_damping, force_drag;
    BodyLinks links;  // pairs of bodies that are joined, for example by a joint; computed by note_changed_seams
    // true if joints (or other rows that join bodies) have changed since `links` was computed
    bool links_open = false;
    // True if any body is asleep. If it is false, stages do not test each body for sleep. Computed by note_rest.
    bool any_asleep = false;
    // true if a body is asleep or a led ghost (a copy for which only the owner of the body computes forces), so that
    // steps compute no forces on it (BodyTable::idle)
    bool any_idle = false;

    /// Sets the number of this world, which is a part of all handles of its objects.
    void set_world(std::uint32_t number);

    Index row(BodyHandle body, const char* call) const;
    Index row(ColliderHandle collider, const char* call) const;
    Index row(MaterialHandle material, const char* call) const;
    Index row(AttachmentHandle attachment, const char* call) const;
    Index row(JointHandle joint, const char* call) const;
    Index row(SurfaceSetHandle set, const char* call) const;
    Index row(TieHandle tie, const char* call) const;
    Index row(CableHandle cable, const char* call) const;
    Index row(CavityHandle cavity, const char* call) const;
    Index row(PipeHandle pipe, const char* call) const;
    Index row(FibreHandle family, const char* call) const;
    Index row(LoadHandle load, const char* call) const;
    Index row(SpringHandle spring, const char* call) const;

    /// All elements, including the elements of sleeping and of unstrained bodies.
    ElementInputs all_elements() const;
    /// The elements whose forces a step computes. It leaves out bodies that are asleep, led ghosts (copies of bodies of
    /// other ranks, GhostKind::led) or marked as unstrained.
    ElementInputs awake_elements() const;
    Range all_blocks() const { return {0, static_cast<Index>(elements.first.size())}; }
    /// Returns the number of a tetrahedron in the mesh given by the user. `lane`: row of the block of the tetrahedron
    /// times element_lanes, plus its lane in the block.
    Index user_tetrahedron(std::size_t body, Index lane) const;

    /// Wakes one body, or all bodies.
    void wake(std::size_t body);
    void wake_all();
    /// Must be called before a step: sets any_asleep, any_idle and BodyTable::idle. Returns the mass of all awake
    /// bodies that are not ghosts [kg].
    Real note_rest();
    /// Must be called after the nodal loads of a body were set. Updates loaded_bodies. `before`: true if the body had
    /// loads before they were set.
    void note_loads(std::size_t body, bool before);
    bool has_loads(std::size_t body) const;
    /// Shape and pose of a round body (a rigid sphere, capsule or cylinder), in the form in which colliders have them.
    struct RoundShape {
        ColliderGeometry geometry;
        RigidMotion motion;  // without velocities
    };
    /// Returns the shape of a round body; nullopt for a body that has faces.
    std::optional<RoundShape> round_shape(std::size_t body) const;
    /// Name of the shape of a round body: "sphere", "capsule" or "cylinder".
    const char* round_name(std::size_t body) const;
    /// True if elements of a body can deform plastically.
    bool yields(std::size_t body) const;
    bool is_rigid(std::size_t body) const { return dynamics_of(body) == BodyDynamics::rigid; }
    BodyDynamics dynamics_of(std::size_t body) const {
        return !has_frame(body)                    ? BodyDynamics::explicit_elastic
               : bodies.implicit[body].size() == 0 ? BodyDynamics::rigid
                                                   : BodyDynamics::implicit_elastic;
    }
    /// True for rigid and implicit bodies, which have a row of rigid_bodies with their momentum, and no rows of
    /// elements.
    bool has_frame(std::size_t body) const { return bodies.rigid[body].size() > 0; }
    /// True if an attachment holds a rigid body as a whole, or the frame of an implicit body.
    bool is_held(std::size_t body) const {
        return has_frame(body) && rigid_bodies.holder[static_cast<std::size_t>(bodies.rigid[body].begin)] != no_index;
    }
    /// True for a rigid body without tetrahedra, or with given mass properties. The mass of such a body is divided
    /// among its nodes so that sums over the nodes give its mass and centre of mass. Single nodes may then have masses
    /// <= 0.
    bool shares_mass(std::size_t body) const;
    /// Mass of a node [kg]. For a body with shares_mass, whose NodeTable::mass may be <= 0, it is the mass of the body
    /// divided by its number of nodes.
    Real weight_of_node(std::size_t node) const;
    /// Inverse mass that a node has while no attachment holds it: the inverse of weight_of_node [1/kg]. It is 0 if that
    /// mass is 0, as for a node that belongs to no tetrahedron.
    Real free_inverse_mass(std::size_t node) const;
    bool node_has_frame(std::size_t node) const {
        return rigid_bodies.size() > 0 && has_frame(static_cast<std::size_t>(nodes.body[node]));
    }
    /// Builds the elements of an implicit body. No table contains them, because steps use the matrices in stiff_bodies
    /// instead. Their node numbers are local to the body.
    ElementList elements_of_implicit(std::size_t body) const;
    /// Computes the matrices of an implicit body (its entry in stiff_bodies) from its record, masses and materials.
    void stiffen(std::size_t body);
    /// Computes the derived columns of newly appended rows. Existing rows do not change.
    void extend_derived();
    /// Computes the derived columns of all rows and counts the bodies with loads. Sets velocity_next and push_out of
    /// all nodes to zero.
    void derive_all();
    /// Builds clusters (groups of nodes that implicit elements couple) again after elements became implicit or
    /// explicit. Without argument, builds those of all bodies; otherwise those of the bodies with a nonzero entry of
    /// `body_changed`.
    void rebuild_clusters();
    void rebuild_clusters(std::span<const std::uint8_t> body_changed);

    /// True if a body has exactly the given mesh (bitwise).
    bool has_mesh(std::size_t body, const RestMesh& mesh) const;
    /// Node positions of the mesh of a body, in the frame of the mesh [m].
    std::span<const Vec3> mesh_shape(std::size_t body) const {
        if (const std::vector<Vec3>& kept = body_records[body].mesh_shape; !kept.empty()) return kept;
        return rows_of(nodes.rest_position, bodies.nodes[body]);
    }
    /// Searches the last few bodies before row `end` for a body that has exactly the given mesh and is not round.
    /// Returns the last such body, or no_index. Data of this body can then be copied.
    Index body_of_mesh(std::size_t end, const RestMesh& mesh) const;

    /// Appends the surface and the bounding volume hierarchy of one body, built from its record and its rest shape. No
    /// later body may have rows in these tables. If one of the last bodies before it has the same mesh, the data of
    /// that body are copied.
    void append_outline(std::size_t body);
    /// Appends a copy of the surface and hierarchy of an earlier body with the same mesh (body_of_mesh). If there is no
    /// such body, returns false and does nothing.
    bool append_outline_again(std::size_t body);
    /// Returns for each face its row of TriangleTable, or no_index if the surface of the body has no such face.
    /// `faces`: numbers of the three nodes within the body, in any order.
    std::vector<Index> triangles_of(std::size_t body, std::span<const std::array<Index, 3>> faces) const;
    /// Computes set_of_feature, which assigns features (triangles, edges and vertices) of surfaces to surface sets. A
    /// feature of several surface sets is assigned to the last of them.
    void index_surface_sets();
    /// Rebuilds the surfaces and bounding volume hierarchies of all bodies.
    void rebuild_outlines();

    /// All tables that for_each_table visits.
    std::vector<AnyTable> tables();
    void for_each_table(auto&& visit) {
        visit("nodes", nodes);
        visit("node_blocks", node_blocks);
        visit("tetrahedra", tetrahedra);
        visit("elements", elements);
        visit("element_nodes", element_nodes);
        visit("surface", surface);
        visit("bvh", bvh);
        visit("bvh_leaves", bvh_leaves);
        visit("bodies", bodies);
        visit("rigid_bodies", rigid_bodies);
        visit("implicit_nodes", implicit_nodes);
        visit("materials", materials);
        visit("colliders", colliders);
        visit("attachments", attachments);
        visit("joints", joints);
        visit("ties", ties);
        visit("cables", cables);
        visit("cavities", cavities);
        visit("pipes", pipes);
        visit("fibres", fibres);
        visit("loads", loads);
        visit("springs", springs);
        visit("disabled_pairs", disabled_pairs);
        visit("material_pairs", material_pairs);
        visit("surface_sets", surface_sets);
    }
    /// Visits the tables whose rows refer to bodies, each with its handles. Their columns with the role `body` contain
    /// rows of BodyTable. Generic code can therefore save, check, hash and renumber these tables, and erase the rows of
    /// a removed body.
    void for_each_joining(auto&& visit) {
        visit("joints", joints, joint_map);
        visit("surface_sets", surface_sets, surface_set_map);
        visit("ties", ties, tie_map);
        visit("cables", cables, cable_map);
        visit("cavities", cavities, cavity_map);
        visit("pipes", pipes, pipe_map);
        visit("fibres", fibres, fibre_map);
        visit("loads", loads, load_map);
        visit("springs", springs, spring_map);
    }
};

}  // namespace skerry
