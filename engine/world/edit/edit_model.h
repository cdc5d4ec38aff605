// Rows of the tables come and go between steps. The caller says so to what is derived from all of them
// (WorldState::settle).
#pragma once

#include <array>
#include <span>

#include "engine/world/state/model.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

struct NewBody {
    std::uint32_t slot = 0;
    BodyKind kind = BodyKind::deformable;
    bool self_contact = false;
    ElementKind element = ElementKind::linear;
    Index material = no_index;                         // of the surface and of what has no other
    std::span<const Index> tetrahedron_material = {};  // by tetrahedron; empty: `material`
    Index collider = no_index;
    Real contact_distance = -1;  // m, < 0: 2 % of the mean edge
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> triangles;  // of a surface without tetrahedra
    Vec3 position;
    Mat3 rotation;
    Vec3 velocity, angular_velocity;
};

// edit_bodies.cpp
/// Appends a surface with or without tetrahedra as a body; returns its row. `stiffness_sum` is memory to work in, by
/// node: kept from body to body, so that each costs what it has itself.
Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body);
void erase_body(Model& model, Index row);

// edit_colliders.cpp; `now` is the time at which they come, s
Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now);
void erase_attachment(Model& model, Index row);
Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now);
void erase_collider(Model& model, Index row);

}  // namespace skerry
