// Adds rows to the tables between steps, after the existing ones, and changes rows (removal: erase_gone.h). The caller
// notes the change in WorldState::edits, so that WorldState::settle updates derived data.
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
    Index material = no_index;                         // material of the surface and of all tetrahedra without another
    std::span<const Index> tetrahedron_material = {};  // row by tetrahedron; empty: `material`
    Index collider = no_index;
    Real contact_distance = -1;  // < 0: 2 % of the mean edge [m]
    Index core_nodes = 0;        // > 0: round body given by its first nodes, see BodyTable; the mesh only draws it
    Real round_radius = 0;       // [m]
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // for a surface without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;

    /// Whether it has a row of RigidBodyTable and no elements.
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
/// Densities by tetrahedron [kg/m^3].
std::vector<Real> densities(const Model& model, const NewBody& body);

/// The tetrahedra that the element at each place covers. `element_at`: the element at each place of its blocks,
/// no_index in an unused lane.
Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at);

/// Appends a surface with or without tetrahedra as a body; returns its row. `stiffness_sum`: working memory by node. It
/// is kept between bodies, so that each body costs only its own size.
Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body);

// choose_dynamics.cpp
/// Chooses whether a new body, given by mesh and placement, is better explicit or implicit. Writes the reason to
/// `estimate`. The model does not change. `body` must be explicit.
BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate);

// body_steps.cpp
/// Groups the tetrahedra by material, in the order in which materials first occur in the mesh.
std::vector<MaterialZone> zones_of(const Model& model, const NewBody& body);
/// Masses of a round body: both ends together, which form a ball, and the shaft between them [kg].
struct RoundMass {
    Real ball, shaft;

    Real sum() const { return ball + shaft; }
};
RoundMass round_mass(const Model& model, const NewBody& body);
/// Adds the lumped masses of the tetrahedra to the nodes and makes these free.
void set_masses(Model& model, const NewBody& body, Range nodes);
/// Finds the mass forms of a body whose mass shares are known, and the frame masses of linear elements (mass_forms.h,
/// frame_masses.h). Drops those that do not lengthen its stable step at rest (frame masses: by a tenth). Returns that
/// step [s].
Real choose_mass_forms(Model& model, Index row, std::span<Real> stiffness_sum);
/// Removes mass forms and frame masses.
void forget_mass_forms(Model& model, Range blocks);
/// Finds relaxation, mass shares and the stable step at rest of the elements of a body. The elements must be in the
/// state in which they were appended.
void find_steps(Model& model, Index row, const NewBody& body, std::span<const MaterialZone> zones,
                Column<Real>& stiffness_sum);
/// Derives a body again after its materials have changed, without reuse of old results.
void restart_elements(Model& model, Index row, const NewBody& body, Column<Real>& stiffness_sum);
/// Results of an earlier body with the same mesh, materials and element kind; nullptr: there are none.
const KnownElements* known_elements(const Model& model, const NewBody& body);
/// Takes known results in place of find_steps, while the elements still lie as in the mesh.
void take_steps(const KnownElements& known, Index row, Model& model);
/// Keeps the results of find_steps of a new body for later bodies of the same mesh. `places`: those of its elements.
void remember_elements(Model& model, Index row, const NewBody& body, ElementPlaces places);

// edit_colliders.cpp; `now` is the time at which the row is added [s]
/// Values that are not given are below zero.
SurfaceProperties surface_properties(const SurfaceSettings& settings);
Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now);
/// Removes an attachment that no handle names any more. Nodes that nothing else holds become free.
void erase_attachment(Model& model, Index row);
Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now);

}  // namespace skerry
