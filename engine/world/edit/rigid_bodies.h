// Creation of rigid bodies, and their update after nodes were moved by anything but a step.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/world/edit/edit_model.h"

namespace skerry {

/// Appends the row of RigidBodyTable of a body whose nodes already have rows.
void append_rigid_body(Model& model, Index row, const NewBody& body);

/// Recomputes mass and inertia after densities have changed; the velocities stay the same.
void weigh_rigid_body(Model& model, std::size_t body, const NewBody& as_new);

/// The pose of a rigid body that is nearest to given node positions. `misfit`: greatest distance of a node of this pose
/// from its given position.
struct RigidFit {
    Vec3 center;
    Mat3 rotation;  // principal frame to world
    Real misfit;    // m
};
RigidFit fit_rigid_body(const Model& model, std::size_t body, std::span<const Vec3> position);

/// Pose of the mesh frame; for a deforming body, of the nearest rigid placement.
RigidPose pose_of_body(const Model& model, std::size_t body);

/// Whether nodes (local numbers) hold a rigid body as a whole, or the frame of an implicit one: three of them must not
/// lie on one line.
bool hold_whole(const Model& model, std::size_t body, std::span<const Index> nodes);
/// Finds the attachments that hold whole bodies or their frames, and the held poses, from the rows of attachments.
void find_holders(Model& model);
/// To be called after an implicit body was attached or released, or its held nodes were moved. Its frame becomes that
/// of its attachment, or its own. Its deformation is chosen so that all nodes keep their positions and velocities.
void follow_attachments(Model& model, std::size_t body);

/// To be called after a free implicit body was weighed again: its inertia follows its shape, its spin stays the same.
void follow_weight(Model& model, std::size_t body);

/// Momenta and inertia of the nodes of a body as point masses, about a centre.
struct NodeMotion {
    Vec3 momentum = Vec3::Zero(), angular_momentum = Vec3::Zero();  // kg m/s, kg m^2/s
    Mat3 inertia = Mat3::Zero();                                    // kg m^2
};
NodeMotion motion_of_nodes(const Model& model, std::size_t body, const Vec3& center);
/// Sets momentum [kg m/s] and angular momentum about the centre [kg m^2/s]; the deformation stays.
void set_momenta(Model& model, std::size_t body, const Vec3& momentum, const Vec3& angular_momentum);
/// Sets both momenta to zero.
void stop_rigid_body(Model& model, std::size_t body);
/// Sets the pose of a body and moves its nodes with it. Angular momentum and velocity stay as they are.
void set_rigid_pose(Model& model, std::size_t body, const Vec3& center, const Mat3& rotation);
/// Gives an implicit body these node positions: its pose is the nearest one, the remainder is its deformation.
void set_deformed_shape(Model& model, std::size_t body, std::span<const Vec3> position);
/// Takes the rigid motion nearest to the velocities of the nodes. The remainder becomes deformation, where possible.
void follow_node_velocities(Model& model, std::size_t body);

/// Energies and momenta of a body with a row of RigidBodyTable; zero for other bodies.
struct RigidSums {
    Real kinetic = 0, elastic = 0;         // J
    Vec3 momentum = Vec3::Zero();          // kg m/s
    Vec3 angular_momentum = Vec3::Zero();  // about the origin [kg m^2/s]
};
RigidSums rigid_sums(const Model& model, std::size_t body);
/// Energies and momenta of the free nodes of a held implicit body; `elastic` is that of the whole body.
RigidSums moving_sums(const Model& model, std::size_t body);
/// Elastic forces on the nodes of an implicit body, by local node, in world axes [N].
std::vector<Vec3> elastic_forces(const Model& model, std::size_t body);

}  // namespace skerry
