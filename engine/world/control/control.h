// Changes between steps that neither add nor remove rows.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

// control_bodies.cpp
/// Refuses node positions of a body that turn one of its tetrahedra inside out. Tetrahedra that are inside out already
/// may stay so. Throws SceneError.
void require_upright(const Model& model, std::size_t body, std::span<const Vec3> position, const std::string& object,
                     const char* field);
/// Moves the nodes of a body, which is checked anew for contacts, overlaps and its stable step.
void place_nodes(WorldState& world, std::size_t body, std::span<const Vec3> position);

// control_collisions.cpp
/// To be called before a slot is used again: enables all of its pairs.
void enable_pairs_of(BodyHandle body, DisabledPairTable& disabled);
void enable_pairs_of(ColliderHandle collider, DisabledPairTable& disabled);

}  // namespace skerry
