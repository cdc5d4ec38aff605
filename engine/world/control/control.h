// What changes between steps without rows that come or go.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

// control_bodies.cpp
/// Refuses positions of the nodes of a body that turn one of its tetrahedra inside out; those that are inside out now
/// may stay so.
void require_upright(const Model& model, std::size_t body, std::span<const Vec3> position, const std::string& object,
                     const char* field);
/// Puts the nodes of a body there, which is looked at anew for contacts, overlaps and the step that it stands.
void place_nodes(WorldState& world, std::size_t body, std::span<const Vec3> position);

// control_collisions.cpp
/// Before a slot is used again: no pair of it is switched off.
void enable_pairs_of(BodyHandle body, DisabledPairTable& disabled);
void enable_pairs_of(ColliderHandle collider, DisabledPairTable& disabled);

}  // namespace skerry
