// Rows of the tables come between steps, behind those that are there, and change (those that go: erase_gone.h). The
// caller says so to what is derived of them (WorldState::settle).
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
    Index material = no_index;                         // of the surface and of what has no other
    std::span<const Index> tetrahedron_material = {};  // by tetrahedron; empty: `material`
    Index collider = no_index;
    Real contact_distance = -1;  // m, < 0: 2 % of the mean edge
    Index core_nodes = 0;        // > 0: round about its first nodes, as in BodyTable; the mesh only draws it
    Real round_radius = 0;       // m
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // of a surface without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;

    /// Has a row of RigidBodyTable, and no elements.
    bool has_frame() const { return dynamics != BodyDynamics::explicit_elastic; }
    /// m, of what is round: 0 of a sphere.
    Real axis_length() const { return core_nodes == 2 ? (nodes[1] - nodes[0]).norm() : 0; }
    bool is_cylinder() const { return core_nodes == cylinder_core_nodes; }
    /// m, of a cylinder.
    Real half_height() const { return (nodes[1] - nodes[0]).norm(); }
    Real rim_radius() const { return (nodes[2] - nodes[1]).norm(); }
    Index material_of(std::size_t of_tetrahedron) const {
        return tetrahedron_material.empty() ? material : tetrahedron_material[of_tetrahedron];
    }
};

// edit_bodies.cpp
/// kg/m^3, by tetrahedron.
std::vector<Real> densities(const Model& model, const NewBody& body);

/// The tetrahedra that the element at each place covers: `element_at` of its blocks, no_index in a lane that is left
/// over.
Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at);

/// Appends a surface with or without tetrahedra as a body; returns its row. `stiffness_sum` is memory to work in, by
/// node: kept from body to body, so that each costs what it has itself.
Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body);

// choose_dynamics.cpp
/// Whether a body that comes, with this as its mesh and place, is better explicit or implicit: says so in the estimate
/// and returns it. Nothing of the model changes; `body` is explicit.
BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate);

// body_steps.cpp
/// Tetrahedra by material, in the order in which the mesh comes to their materials.
std::vector<MaterialZone> zones_of(const Model& model, const NewBody& body);
/// kg, of a body that is round: both ends together, which are a ball, and what lies between.
struct RoundMass {
    Real ball, shaft;

    Real sum() const { return ball + shaft; }
};
RoundMass round_mass(const Model& model, const NewBody& body);
/// Adds the masses of the tetrahedra to those of the nodes, which are free then.
void set_masses(Model& model, const NewBody& body, Range nodes);
/// Finds the mass forms of a body, whose masses are shared, and of linear elements the masses in its frame
/// (mass_forms.h, frame_masses.h), and leaves those out that do not make its step at rest longer. Returns that step, s.
Real choose_mass_forms(Model& model, Index row, std::span<Real> stiffness_sum);
/// Takes both away.
void forget_mass_forms(Model& model, Range blocks);
/// How the elements of a body relax, how they share its masses and which step they stand at rest. Its elements are as
/// new.
void find_steps(Model& model, Index row, const NewBody& body, std::span<const MaterialZone> zones,
                Column<Real>& stiffness_sum);
/// Derives a body again after its materials have changed, without anything kept from the old ones.
void restart_elements(Model& model, Index row, const NewBody& body, Column<Real>& stiffness_sum);
/// What bodies that came before have found out for a new one of their mesh, materials and element; nullptr: nothing.
const KnownElements* known_elements(const Model& model, const NewBody& body);
/// In place of find_steps, of a body whose elements lie as its mesh does.
void take_steps(const KnownElements& known, Index row, Model& model);
/// Keeps the results of find_steps of a new body for later bodies of the same mesh. `places` of its elements.
void remember_elements(Model& model, Index row, const NewBody& body, ElementPlaces places);

// edit_colliders.cpp; `now` is the time at which they come, s
/// What is not given is below zero.
SurfaceProperties surface_properties(const SurfaceSettings& settings);
Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now);
/// Its nodes are free again, where nothing else holds them. No handle names it any more.
void erase_attachment(Model& model, Index row);
Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now);

}  // namespace skerry
