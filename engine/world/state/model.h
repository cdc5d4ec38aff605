// The simulated objects in their present state: bodies, colliders, attachments, materials and gravity.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/any_table.h"
#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/collider_table.h"
#include "components/collision_filter.h"
#include "components/element_table.h"
#include "components/handle.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/ragged.h"
#include "components/range.h"
#include "components/rigid_body_table.h"
#include "components/step_watch.h"
#include "components/surface_table.h"
#include "engine/world/state/known_elements.h"
#include "engine/world/tuning.h"
#include "skerry/mesh.h"
#include "skerry/settings.h"
#include "skerry/world.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Slot of an attachment that belongs to a mesh collider: users have no handle to it.
inline constexpr std::uint32_t no_slot = 0xffffffffu;

/// Data of a body that only users and files read.
struct BodyRecord {
    std::string name;
    ElementKind element;  // never `smoothed`, but one of the two kinds that it stands for
    ElementKind asked;    // the kind requested by the user; used again where the dynamics change
    std::vector<std::array<Index, 4>> tetrahedra;  // local nodes
    std::vector<std::array<Index, 3>> surface;     // local nodes
    std::vector<Index> tetrahedron_material;       // rows of MaterialTable; empty: the material of the body
    // the tetrahedra covered by the element at each place of its blocks; none in an unused lane
    Ragged<Index> element_tetrahedra;
    bool settled = false;       // it was checked for overlaps
    DynamicsEstimate choice{};  // estimate of BodyDynamics::automatic
};

struct ColliderRecord {
    std::string name;
    Shape shape;
    bool settled = false;  // it was checked for overlaps
};

struct Model {
    Settings settings;
    Tuning tuning;

    NodeTable nodes;
    NodeBlockTable node_blocks;
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable element_nodes;
    ElementPatches patches;  // derived: extend_derived
    // Clusters of the implicit elements. State: matrices of elements that have stiffened were updated, not made anew.
    NodeClusters clusters;
    RigidBodyTable rigid_bodies;
    ImplicitNodeTable implicit_nodes;
    StiffBodies stiff_bodies;  // by row of rigid_bodies; derived: derive_all, stiffen
    SurfaceTables surface;
    BvhTable bvh;
    BvhLeafTable bvh_leaves;
    BodyTable bodies;
    MaterialTable materials;
    ColliderTable colliders;
    AttachmentTable attachments;
    JointTable joints;
    DisabledPairTable disabled_pairs;
    HandleMap<MaterialHandle> material_map;
    HandleMap<BodyHandle> body_map;
    HandleMap<ColliderHandle> collider_map;
    HandleMap<AttachmentHandle> attachment_map;
    HandleMap<JointHandle> joint_map;
    StepWatch watch;
    std::vector<BodyRecord> body_records;          // by row
    std::vector<ColliderRecord> collider_records;  // by row
    std::vector<KnownElements> known_elements;     // one for each mesh added since the world was settled

    Column<Real> body_mass;  // mass of all nodes of a body, including held ones [kg]; derived: extend_derived
    // bodies, colliders or settings have changed since the implicit elements were last chosen
    bool clusters_open = true;
    bool settled = true;      // true if all bodies and colliders are settled
    Index loaded_bodies = 0;  // number of bodies with loads; derived: derive_all, note_loads
    bool forced = false;      // the world has some force element, loads included; derived: note_seams
    Column<Real> force_rate;  // by body: see ForceElement::add_rate; empty: zero [1/s^2]; derived: note_seams
    BodyLinks links;          // by rows of the tables of for_each_joining; derived: note_seams
    bool any_asleep = false;  // some body rests; derived: note_rest. If false, no stage tests for rest

    /// Sets the world number that its handles carry.
    void set_world(std::uint32_t number);

    Index row(BodyHandle body, const char* call) const;
    Index row(ColliderHandle collider, const char* call) const;
    Index row(MaterialHandle material, const char* call) const;
    Index row(AttachmentHandle attachment, const char* call) const;
    Index row(JointHandle joint, const char* call) const;

    /// All elements, including those that do nothing in the present step.
    ElementInputs all_elements() const;
    /// The elements of bodies that are neither asleep nor unstrained.
    ElementInputs awake_elements() const;
    Range all_blocks() const { return {0, static_cast<Index>(elements.first.size())}; }
    /// Number of a tetrahedron in the mesh that the user gave. `place`: its place in the table.
    Index user_tetrahedron(std::size_t body, Index place) const;

    /// Wakes one body, or all.
    void wake(std::size_t body);
    void wake_all();
    /// Before a step: notes whether any body is asleep. Returns the mass of all others [kg].
    Real note_rest();
    /// After loads of one body were set. `before`: it had loads before.
    void note_loads(std::size_t body, bool before);
    bool has_loads(std::size_t body) const;
    /// Shape and pose of a round body, in the form of a collider.
    struct RoundShape {
        ColliderGeometry geometry;
        RigidMotion motion;  // without velocities
    };
    /// nullopt: the body is not round but has faces.
    std::optional<RoundShape> round_shape(std::size_t body) const;
    /// "sphere", "capsule" or "cylinder", for a round body.
    const char* round_name(std::size_t body) const;
    bool is_rigid(std::size_t body) const { return dynamics_of(body) == BodyDynamics::rigid; }
    BodyDynamics dynamics_of(std::size_t body) const {
        return !has_frame(body)                    ? BodyDynamics::explicit_elastic
               : bodies.implicit[body].size() == 0 ? BodyDynamics::rigid
                                                   : BodyDynamics::implicit_elastic;
    }
    /// Whether it has a row of rigid_bodies: that row holds its momentum, its nodes do not, and it has no elements.
    bool has_frame(std::size_t body) const { return bodies.rigid[body].size() > 0; }
    /// Whether an attachment holds a rigid body as a whole.
    bool is_held(std::size_t body) const {
        return has_frame(body) && rigid_bodies.holder[static_cast<std::size_t>(bodies.rigid[body].begin)] != no_index;
    }
    bool node_has_frame(std::size_t node) const {
        return rigid_bodies.size() > 0 && has_frame(static_cast<std::size_t>(nodes.body[node]));
    }
    /// The elements of an implicit body, which are in no table. Its nodes are numbered from zero.
    ElementList elements_of_implicit(std::size_t body) const;
    /// Computes stiff_bodies of an implicit body from its record, masses and materials.
    void stiffen(std::size_t body);
    /// Computes the derived columns of newly appended rows. Existing rows are unchanged.
    void extend_derived();
    /// Computes the derived columns of all rows, of loads, and the next velocities of bodies that a step skips.
    void derive_all();
    /// After elements became implicit or explicit: rebuilds the clusters of all bodies, or of those with a mark.
    void rebuild_clusters();
    void rebuild_clusters(std::span<const std::uint8_t> body_changed);

    /// Whether a body has exactly this mesh (bitwise).
    bool has_mesh(std::size_t body, const RestMesh& mesh) const;
    /// The last of a few bodies before row `end` that has this mesh, or no_index.
    Index body_of_mesh(std::size_t end, const RestMesh& mesh) const;

    /// Builds the surface and the tree of one body from its record and its rest shape. The body must be the last with
    /// rows in these tables. Data of the body just before it with the same mesh are reused.
    void append_outline(std::size_t body);
    /// Copies surface and tree of a body just before it with the same mesh. Returns false, and does nothing, without
    /// one.
    bool append_outline_again(std::size_t body);
    /// Rebuilds surfaces and trees of all bodies.
    void rebuild_outlines();

    /// The tables that for_each_table visits.
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
        visit("disabled_pairs", disabled_pairs);
    }
    /// Tables whose rows join bodies, each with its handles. They need no code of their own to be saved, checked,
    /// hashed, renumbered, or erased with a body: the role `body` of a column says which bodies a row joins.
    void for_each_joining(auto&& visit) { visit("joints", joints, joint_map); }
};

}  // namespace skerry
