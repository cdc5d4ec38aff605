// Appends rows to the tables between steps, and changes rows (erase_gone.h removes them). The caller records the change
// in WorldState::edits, so that WorldState::settle updates derived data.
#pragma once

#include <array>
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
    Index material = no_index;  // material of the surface and of tetrahedra that have no other material
    // row of MaterialTable for each tetrahedron; empty: `material` for all
    std::span<const Index> tetrahedron_material = {};
    Index collider = no_index;
    Real contact_distance = -1;  // contact distance [m]; negative: 2 % of the mean surface edge
    // Number of nodes that define a round body (see BodyTable); 0: not a round body. All other nodes of a round body
    // only draw it.
    Index core_nodes = 0;
    Real round_radius = 0;  // [m]
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // surface of a body without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;

    /// True for rigid and implicit bodies: they have a row of RigidBodyTable and no rows of elements.
    bool has_frame() const { return dynamics != BodyDynamics::explicit_elastic; }
    /// Axis length of a capsule; 0 for other bodies [m].
    Real axis_length() const { return core_nodes == 2 ? (nodes[1] - nodes[0]).norm() : 0; }
    bool is_cylinder() const { return core_nodes == cylinder_core_nodes; }
    /// Half height and rim radius of a cylinder [m].
    Real half_height() const { return (nodes[1] - nodes[0]).norm(); }
    Real rim_radius() const { return (nodes[2] - nodes[1]).norm(); }
    Index material_of(std::size_t of_tetrahedron) const {
        return tetrahedron_material.empty() ? material : tetrahedron_material[of_tetrahedron];
    }
};

// edit_bodies.cpp

/// Density of each tetrahedron [kg/m^3].
std::vector<Real> densities(const Model& model, const NewBody& body);

/// Lists the tetrahedra that each element of a body covers. The order is that of the lanes in the element blocks of the
/// body. `element_at`: number of the element in each lane; no_index in an unused lane.
Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at);

/// Appends a surface, with or without tetrahedra, as a body. Returns its row. `stiffness_sum`: working memory with one
/// entry per node. It is kept between calls, so that the cost of a call depends only on the size of this body.
Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body);

// choose_dynamics.cpp

/// Decides whether a new body, given by its mesh and placement, should be explicit or implicit. Writes the reason to
/// `estimate`. The model does not change. `body` must be explicit.
BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate);

// body_steps.cpp

/// Groups the tetrahedra by material. The groups are in the order in which their materials first occur in the mesh.
std::vector<MaterialZone> zones_of(const Model& model, const NewBody& body);
/// Masses of the parts of a round body: a ball, made of both ends, and the shaft between the ends [kg].
struct RoundMass {
    Real ball, shaft;

    Real sum() const { return ball + shaft; }
};
RoundMass round_mass(const Model& model, const NewBody& body);
/// Adds the lumped masses of the tetrahedra to the node masses, and makes all these nodes free.
void set_masses(Model& model, const NewBody& body, Range nodes);
/// Finds the mass forms of a body whose mass shares are known, and the frame masses of linear elements (mass_forms.h,
/// frame_masses.h). Mass forms that do not lengthen the stable step at rest are dropped; so are frame masses that do
/// not lengthen it by a tenth. Returns the stable step at rest [s].
Real choose_mass_forms(Model& model, Index row, std::span<Real> stiffness_sum);
/// Removes the mass forms and frame masses of the elements in `blocks`.
void forget_mass_forms(Model& model, Range blocks);
/// Finds relaxation, mass shares and the stable step at rest of the elements of a body. The elements must be unchanged
/// since they were appended.
void find_steps(Model& model, Index row, const NewBody& body, std::span<const MaterialZone> zones,
                Column<Real>& stiffness_sum);
/// Computes masses and steps of a body again after its materials have changed. Does not reuse old results.
void restart_elements(Model& model, Index row, const NewBody& body, Column<Real>& stiffness_sum);
/// Returns the results of an earlier body with the same mesh, materials and element kind; nullptr if there are none.
const KnownElements* known_elements(const Model& model, const NewBody& body);
/// Copies known results to a new body, in place of find_steps. The elements must not be rotated yet.
void take_steps(const KnownElements& known, Index row, Model& model);
/// Stores the results of find_steps for later bodies with the same mesh. `places`: places of the elements of the body
/// in its blocks.
void remember_elements(Model& model, Index row, const NewBody& body, ElementPlaces places);

// edit_colliders.cpp; `now` is the time at which the row is added [s]

/// Properties that the settings leave out are set to -1.
SurfaceProperties surface_properties(const SurfaceSettings& settings);
Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now);
/// Removes an attachment after its handle was removed. Its nodes become free unless another attachment holds them.
void erase_attachment(Model& model, Index row);
Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now);

}  // namespace skerry
