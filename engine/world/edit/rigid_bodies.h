// Rigid bodies as they come, and after something else than a step has moved their nodes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/world/edit/edit_model.h"

namespace skerry {

/// Gives a body, whose nodes are there, the row of RigidBodyTable that its mesh makes.
void append_rigid_body(Model& model, Index row, const NewBody& body);

/// Mass and inertia again, after densities have changed; it goes on with the velocity that it has.
void weigh_rigid_body(Model& model, std::size_t body, const NewBody& as_new);

/// Where a rigid body is whose nodes are at `position`, and how far the farthest of them is from where it has them
/// then.
struct RigidFit {
    Vec3 center;
    Mat3 rotation;  // principal frame to world
    Real misfit;    // m
};
RigidFit fit_rigid_body(const Model& model, std::size_t body, std::span<const Vec3> position);

/// Where the frame of its mesh is, of a body that deforms the nearest.
RigidPose pose_of_body(const Model& model, std::size_t body);

/// Whether nodes (local numbers) hold a rigid body as a whole, or the frame of an implicit one: three of them that are
/// not on one line.
bool hold_whole(const Model& model, std::size_t body, std::span<const Index> nodes);
/// Which attachments hold whole bodies or their frames, and where: what is derived of the rows of attachments.
void find_holders(Model& model);
/// After an implicit body was attached or let go, or its held nodes put elsewhere: its frame is that of its attachment
/// or its own, and what deforms in it is what leaves nodes where they are, with the velocities that they have.
void follow_attachments(Model& model, std::size_t body);

/// After a free implicit body was weighed again: it turns as its shape does, as fast as it did.
void follow_weight(Model& model, std::size_t body);

/// Of the nodes of a body as points, about a centre.
struct NodeMotion {
    Vec3 momentum = Vec3::Zero(), angular_momentum = Vec3::Zero();  // kg m/s, kg m^2/s
    Mat3 inertia = Mat3::Zero();                                    // kg m^2
};
NodeMotion motion_of_nodes(const Model& model, std::size_t body, const Vec3& center);
/// Gives it momentum (kg m/s) and angular momentum about its centre (kg m^2/s); what deforms it stays.
void set_momenta(Model& model, std::size_t body, const Vec3& momentum, const Vec3& angular_momentum);
/// Takes its momenta.
void stop_rigid_body(Model& model, std::size_t body);
/// The pose of a body, and its nodes where that has them. Angular momentum and velocity stay as they are.
void set_rigid_pose(Model& model, std::size_t body, const Vec3& center, const Mat3& rotation);
/// The pose of a body that moves implicitly nearest to these positions, and what is beside it as its deformation.
void set_deformed_shape(Model& model, std::size_t body, std::span<const Vec3> position);
/// The rigid motion nearest to the velocities of its nodes; the rest deforms it, where it can.
void follow_node_velocities(Model& model, std::size_t body);

/// What a body carries that has a row of RigidBodyTable; zero for others.
struct RigidSums {
    Real kinetic = 0, elastic = 0;         // J
    Vec3 momentum = Vec3::Zero();          // kg m/s
    Vec3 angular_momentum = Vec3::Zero();  // kg m^2/s, about the origin
};
RigidSums rigid_sums(const Model& model, std::size_t body);
/// The same of the nodes that move in the frame of a held implicit body.
RigidSums moving_sums(const Model& model, std::size_t body);
/// N, what elasticity does to the nodes of an implicit body, by node of it, world.
std::vector<Vec3> elastic_forces(const Model& model, std::size_t body);

}  // namespace skerry
