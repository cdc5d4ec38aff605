// Functions of the files control_*.cpp that other files call. They change objects of a world or return their present
// state.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "components/pair_table.h"
#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/spring.h"
#include "skerry/tie.h"

namespace skerry {

/// Converts the keys of one table row to a TimeTable, which settings use.
inline TimeTable time_table_of(std::span<const TimeKey> keys) {
    return std::vector<TimeKey>(keys.begin(), keys.end());
}
/// Returns the state of a world for a function that changes it. `call`: name of this function, for the message. Throws
/// SceneError during a call of advance.
inline WorldState& state_between_steps(World& world, const char* call) {
    WorldState& state = WorldAccess::state_of(world);
    state.require_between_steps(call);
    return state;
}
/// Handle of the body in a row of BodyTable.
inline BodyHandle handle_of_body(const Model& model, Index row) {
    return model.body_map.handle_of_slot(model.bodies.slot[static_cast<std::size_t>(row)]);
}

// control_bodies.cpp

/// Throws SceneError if the node positions turn a tetrahedron of the body inside out. Tetrahedra that are already
/// inside out may remain so.
void require_upright(const Model& model, std::size_t body, std::span<const Vec3> position, const std::string& object,
                     const char* field);
/// Moves the nodes of a body, lets its elements yield plastically, and evaluates the stable step of the body again. In
/// the next step the contacts and overlaps of the body are searched again.
void place_nodes(WorldState& world, std::size_t body, std::span<const Vec3> position);
/// Changes the attachments of a body so that they hold their nodes at the present positions. `now`: present time [s].
void hold_here(Model& model, std::size_t body, Real now);

// control_collisions.cpp

/// Enables the collisions of a body or collider with all objects for which they are disabled. Must be called before the
/// slot of this object is reused, because the table of disabled pairs names objects by slot.
void enable_pairs_of(BodyHandle body, DisabledPairTable& disabled);
void enable_pairs_of(ColliderHandle collider, DisabledPairTable& disabled);
/// Enables the collisions of a pair again, during a call of advance. Does nothing if they are not disabled. `first`:
/// row of BodyTable; `second`: row of BodyTable or ColliderTable, depending on `kind`.
void enable_pair(WorldState& world, PairKind kind, Index first, Index second);

// control_cables.cpp

/// Returns the present shape and motion of a cable, and its tensions in the last step.
CableState cable_state(const WorldState& state, CableHandle cable);

// control_cavities.cpp

CavityState cavity_state(const WorldState& world, CavityHandle cavity);
/// Stores the present face positions of a body's open cavities with a gas or a liquid. The volume of such a cavity
/// changes by the volume that its faces sweep from the stored positions. Must be called after nodes were placed between
/// steps, so that the placement does not change the volume.
void renew_corners(Model& model, std::size_t body);

// control_dynamics.cpp

/// Lets all viscous stress of an explicit body relax: the springs of its Maxwell elements get the strains that they
/// would have after a long time in the present shape.
void relax_fully(Model& model, std::size_t body);

// control_joints.cpp

/// Returns the present pose and motion of a joint, and its force and moment in the last step.
JointState joint_state(const Model& model, JointHandle joint);

// control_materials.cpp

/// Returns the surface properties as settings. A negative value in `surface` marks a property that is not set; its
/// optional value is then empty.
SurfaceSettings set_values_of(const SurfaceProperties& surface);

// control_ties.cpp

/// Returns the state of a tie, with the forces of the last step.
TieState tie_state(const WorldState& world, TieHandle tie);
/// Finds the ties whose nodes have all broken off, and enables the collisions that such a tie had switched off, unless
/// another tie keeps them off. Must be called after a step in which the last node of a tie has broken off.
void release_ties(WorldState& world);

// control_fibres.cpp

/// Returns the present state of fibres (Fibres::state).
FibreState fibre_state(const WorldState& world, FibreHandle fibres);

// control_motion.cpp

/// Moves a collider or an attachment from its present pose through all poses, with constant velocities between them,
/// and stops it at the last one. The times of the poses must increase and be later than the present time. The rotation
/// from each pose to the next must be less than half a revolution.
void follow_poses(World& world, ColliderHandle collider, std::span<const Keyframe> poses);
void follow_poses(World& world, AttachmentHandle attachment, std::span<const Keyframe> poses);

// control_springs.cpp

/// Returns the present state of a spring.
SpringState spring_state(const WorldState& world, SpringHandle spring);

}  // namespace skerry
