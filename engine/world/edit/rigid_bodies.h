// Creation of rigid bodies, and updates of rigid and implicit bodies after changes of their nodes between steps.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/world/edit/edit_model.h"

namespace skerry {

/// Appends the row of RigidBodyTable for a body whose nodes are already in the tables.
void append_rigid_body(Model& model, Index row, const NewBody& body);

/// Copies the mass properties that the user has given for a body to `as_new`, which describes the body as a new one.
void keep_given_mass(const Model& model, std::size_t body, NewBody& as_new);
/// Computes mass and inertia of a body again after densities have changed. The velocity and angular velocity of the
/// body do not change.
void weigh_rigid_body(Model& model, std::size_t body, const NewBody& as_new);

/// Pose of a rigid or implicit body that is nearest to given node positions. `center`: centre of mass in this pose [m].
/// `misfit`: largest distance of a node in this pose from its given position [m].
struct RigidFit {
    Vec3 center;
    Mat3 rotation;  // rotation from the frame of the principal axes to world axes
    Real misfit;    // [m]
};
RigidFit fit_rigid_body(const Model& model, std::size_t body, std::span<const Vec3> position);

/// Pose of the mesh frame of a body. For an explicit body it is the rigid pose nearest to the deformed shape.
RigidPose pose_of_body(const Model& model, std::size_t body);

/// True if a body can neither move nor rotate while the given nodes (local numbers) are held, which requires that they
/// do not all lie on one line.
bool hold_whole(const Model& model, std::size_t body, std::span<const Index> nodes);
/// Finds the attachments that hold whole rigid bodies or the frames of implicit bodies, and the pose of each held body
/// relative to its attachment.
void find_holding_attachments(Model& model);
/// Lets an implicit body deform relative to the frame of its attachment, or to its own frame if it is free. Must be
/// called after the body was attached or released, or after its held nodes were moved. All nodes keep their positions
/// and velocities.
void follow_attachments(Model& model, std::size_t body);

/// Must be called after the mass of a free implicit body was computed again. Computes the inertia of the deformed
/// shape. The velocity and angular velocity of the body do not change.
void follow_weight(Model& model, std::size_t body);

/// Momenta and inertia of the nodes of a body, treated as point masses (Model::weight_of_node), about a given centre.
struct NodeMotion {
    Vec3 momentum = Vec3::Zero(), angular_momentum = Vec3::Zero();  // [kg m/s, kg m^2/s]
    Mat3 inertia = Mat3::Zero();                                    // [kg m^2]
};
NodeMotion motion_of_nodes(const Model& model, std::size_t body, const Vec3& center);
/// Sets the momentum [kg m/s] and the angular momentum about the centre of mass [kg m^2/s] of a body. The deformation
/// does not change.
void set_momenta(Model& model, std::size_t body, const Vec3& momentum, const Vec3& angular_momentum);
/// Sets the momentum and the angular momentum of a body to zero.
void stop_rigid_body(Model& model, std::size_t body);
/// Sets the centre of mass of a body and the rotation from its principal axes to the world, and moves its nodes along.
/// The momentum and the angular momentum do not change.
void set_rigid_pose(Model& model, std::size_t body, const Vec3& center, const Mat3& rotation);
/// Sets the node positions of an implicit body. The nearest rigid pose becomes the pose of the body, and the difference
/// from this pose becomes its deformation.
void set_deformed_shape(Model& model, std::size_t body, std::span<const Vec3> position);
/// Sets the momenta of a body to those of the rigid motion nearest to its node velocities. The difference from this
/// motion becomes the deformation velocity of an implicit body, and is lost for a rigid body.
void follow_node_velocities(Model& model, std::size_t body);

/// Energies and momenta of a rigid or implicit body; zero for an explicit body.
struct RigidSums {
    Real kinetic = 0, elastic = 0;         // [J]
    Vec3 momentum = Vec3::Zero();          // [kg m/s]
    Vec3 angular_momentum = Vec3::Zero();  // about the origin [kg m^2/s]
};
RigidSums rigid_sums(const Model& model, std::size_t body);
/// Energies and momenta of the free nodes of a held implicit body; `elastic` is the energy of the whole body.
RigidSums moving_sums(const Model& model, std::size_t body);
/// Elastic forces on the nodes of an implicit body, by local node, in world axes [N].
std::vector<Vec3> elastic_forces(const Model& model, std::size_t body);

}  // namespace skerry
