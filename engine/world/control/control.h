// Changes of a world between steps that neither add nor remove table rows.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/world/world_state.h"
#include "skerry/joint.h"
#include "skerry/spring.h"

namespace skerry {

// control_bodies.cpp

/// Throws SceneError if the node positions turn a tetrahedron of the body inside out. Tetrahedra that are already
/// inside out may remain so.
void require_upright(const Model& model, std::size_t body, std::span<const Vec3> position, const std::string& object,
                     const char* field);
/// Moves the nodes of a body and evaluates the stable step of the body again. In the next step the contacts and
/// overlaps of the body are searched again.
void place_nodes(WorldState& world, std::size_t body, std::span<const Vec3> position);
/// Changes the attachments of a body so that they hold their nodes at the present positions. `now`: present time [s].
void hold_here(Model& model, std::size_t body, Real now);

// control_collisions.cpp

/// Enables all disabled pairs of a body or collider. Must be called before the slot of this object is reused.
void enable_pairs_of(BodyHandle body, DisabledPairTable& disabled);
void enable_pairs_of(ColliderHandle collider, DisabledPairTable& disabled);

// control_joints.cpp

/// Returns the present pose and motion of a joint, and its force and moment in the last step.
JointState joint_state(const Model& model, JointHandle joint);

// control_springs.cpp

/// Returns the present state of a spring.
SpringState spring_state(const WorldState& world, SpringHandle spring);

}  // namespace skerry
