// Functions that append and change rows of the tables between steps (erase_gone.h removes rows). The caller records
// each change in WorldState::edits, so that WorldState::settle updates derived data.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/dynamics/kinds/element_list.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

struct NewBody {
    std::uint32_t slot = 0;
    BodyKind kind = BodyKind::deformable;
    bool self_contact = false;
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;
    CollisionFilter filter = {};
    ElementKind element = ElementKind::linear;
    Index material = no_index;  // material of the surface, and of all tetrahedra without a material of their own
    // material of each tetrahedron, as row of MaterialTable; empty: all have `material`
    std::span<const Index> tetrahedron_material = {};
    Index collider = no_index;
    Real contact_distance = -1;  // contact distance [m]; negative: 2 % of the mean surface edge is used
    // Number of core nodes, which define the shape of a round body: a sphere, capsule or cylinder (see BodyTable). Its
    // other nodes serve only to draw it. 0: the body is not round.
    Index core_nodes = 0;
    Real round_radius = 0;  // [m]
    std::span<const Vec3> nodes;
    // Node positions [m] that determine the masses of the tetrahedra; empty: `nodes`. Used for a body that is frozen in
    // the deformed shape `nodes`, and whose masses follow from its undeformed mesh.
    std::span<const Vec3> mesh_shape = {};
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // surface triangles of a body without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;
    // mass properties that the user has given (BodySettings); those left empty are computed from the shape
    std::optional<Real> mass = {};
    std::optional<Vec3> center_of_mass = {};
    std::optional<Mat3> inertia = {};

    /// True for rigid and implicit bodies, which have a row of RigidBodyTable and no rows of elements.
    bool has_frame() const { return dynamics != BodyDynamics::explicit_elastic; }
    /// Axis length of a capsule; 0 for other bodies [m].
    Real axis_length() const { return core_nodes == 2 ? (nodes[1] - nodes[0]).norm() : 0; }
    bool is_cylinder() const { return core_nodes == cylinder_core_nodes; }
    /// Half height and rim radius of a cylinder [m].
    Real half_height() const { return (nodes[1] - nodes[0]).norm(); }
    Real rim_radius() const { return (nodes[2] - nodes[1]).norm(); }
    GivenMass given_mass() const { return inertia ? GivenMass::all : mass ? GivenMass::mass : GivenMass::none; }
    std::span<const Vec3> shape_of_masses() const { return mesh_shape.empty() ? nodes : mesh_shape; }
    Index material_of(std::size_t of_tetrahedron) const {
        return tetrahedron_material.empty() ? material : tetrahedron_material[of_tetrahedron];
    }
};

// edit_bodies.cpp

/// Density of each tetrahedron [kg/m^3].
std::vector<Real> densities(const Model& model, const NewBody& body);

/// Lists the tetrahedra that each element of a body covers, in the order of the SIMD lanes in the body's element
/// blocks. `element_at`: number of the element in each lane; no_index in an unused lane.
Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at);

/// Appends a body that consists of a surface, with or without tetrahedra. Returns its row.
/// - `stiffness_sum`: working memory with one entry per node. The caller keeps it between calls, so that the cost of a
///   call depends only on the size of the new body.
/// - `trial`: results of choose_dynamics() for this body. Null: results stored for an earlier body with the same mesh
///   are used, if there are any.
Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body, const KnownElements* trial = nullptr);

// choose_dynamics.cpp

/// Throws SceneError if a material of the implicit body `name` sets a loss factor above 0, or yields.
/// `tetrahedron_material`: material of each tetrahedron; empty if all have `material`.
void require_implicit_materials(const Model& model, Index material, std::span<const Index> tetrahedron_material,
                                const std::string& name);
/// Throws SceneError, because a material of the implicit body with this name sets a loss factor above 0.
[[noreturn]] void refuse_losses(const std::string& body);

/// Decides whether a new body should be explicit or implicit, and writes the reason to `estimate`. The cost estimate
/// needs results of find_steps(). If none are stored for the same mesh, computes them and writes them to `trial`.
/// `body.dynamics` must be explicit_elastic.
BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate,
                             std::optional<KnownElements>& trial);

/// Returns the row of a body that became implicit by choose_dynamics, but for which explicit steps now cost less
/// because bodies were added that require short steps; no_index if there is none. Writes the new estimate for this body
/// to `now`.
Index outdated_choice(const Model& model, DynamicsEstimate& now);

// body_steps.cpp

/// Groups the tetrahedra of a body by material. The groups are in the order in which the materials first occur in the
/// mesh.
std::vector<MaterialZone> zones_of(const Model& model, const NewBody& body);
/// Masses of the two parts of a round body [kg]: the ball that both ends form together, and the shaft between the ends.
/// A cylinder consists of the shaft only.
struct RoundMass {
    Real ball, shaft;

    Real sum() const { return ball + shaft; }
};
RoundMass round_mass(const Model& model, const NewBody& body);
/// Mass properties of a rigid or implicit body in the frame of its mesh. Properties that the user has not given follow
/// from its shape: a set of tetrahedra, the inside of a closed surface, or a sphere, capsule or cylinder along z.
struct MassProperties {
    Real mass = 0;               // [kg]
    Vec3 center = Vec3::Zero();  // [m]
    Vec3 moments;                // principal moments of inertia [kg m^2]
    Mat3 axes;                   // rotation from the frame of the principal axes to the mesh frame
};
MassProperties mass_properties(const Model& model, const NewBody& body);
/// Adds the lumped masses of the tetrahedra to the node masses, and sets the inverse masses. An inverse mass above 0
/// lets a node move.
void set_masses(Model& model, const NewBody& body, Range nodes);
/// Divides the node masses among the elements of a body so that the stable step becomes long
/// (docs/methods/stable_step.md 2). Returns the stable step at rest [s]. The mass shares must be known. Mass forms are
/// kept if they lengthen the step. Frame masses, which only linear elements get, are kept if they lengthen it by a
/// tenth.
Real choose_mass_forms(Model& model, Index row, std::span<Real> stiffness_sum);
/// Removes the mass forms and frame masses of the elements in `blocks`.
void forget_mass_forms(Model& model, Range blocks);
/// Finds the relaxation rates and mass shares of the elements of a body, and its stable step at rest. The elements must
/// have the orientation of the mesh, and must have no mass forms, frame masses or relaxation rates yet.
void find_steps(Model& model, Index row, const NewBody& body, std::span<const MaterialZone> zones,
                Column<Real>& stiffness_sum);
/// Computes masses and stable steps of a body again after its materials have changed. Stored results of earlier bodies
/// are not used.
void restart_elements(Model& model, Index row, const NewBody& body, Column<Real>& stiffness_sum);
/// Returns the stored results of find_steps for an earlier body with the same mesh, materials and element kind; nullptr
/// if there are none.
const KnownElements* known_elements(const Model& model, const NewBody& body);
/// Copies stored results to a new body. This replaces a call of find_steps. The elements must still have the
/// orientation of the mesh; append_body() later rotates them to the orientation of the body.
void take_steps(const KnownElements& known, Index row, Model& model);
/// Stores the results of find_steps for later bodies with the same mesh. `places`: element in each SIMD lane of the
/// element blocks of the body.
void remember_elements(Model& model, Index row, const NewBody& body, ElementPlaces places);
/// Stores `trial`, computed by choose_dynamics() for the body `row`, for use by later bodies with the same mesh.
void remember_elements(Model& model, Index row, KnownElements trial);

// The following functions are defined in edit_colliders.cpp. The argument `now` is the time at which the row is added
// [s].

/// Returns surface properties, in which -1 marks a value that the settings leave out.
SurfaceProperties surface_properties(const SurfaceSettings& settings);
/// Appends the row of an attachment and returns its index. `held`: directions along which the nodes are held, as in
/// AttachmentTable.
Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now, const Mat3& held = Mat3::Identity());
/// Removes the row of an attachment whose handle was already removed. The attached nodes become free unless another
/// attachment holds them.
void erase_attachment(Model& model, Index row);
Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now);

}  // namespace skerry
