#include "engine/world/edit/rigid_bodies.h"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "components/any_table.h"
#include "systems/dynamics/implicit/free_large_step.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

namespace {

void write_masses(const MassProperties& found, std::size_t r, RigidBodyTable& table) {
    table.mass[r] = found.mass;
    table.moments[r] = found.moments;
    table.axes[r] = found.axes;
    table.rest_center[r] = found.center;
}

std::size_t rigid_row(const Model& model, std::size_t body) {
    return static_cast<std::size_t>(model.bodies.rigid[body].begin);
}

Vec3 spin(const RigidBodyTable& table, std::size_t r) {
    return spin_of(table.rotation[r], table.moments[r], table.angular_momentum[r]);
}

void set_motion(RigidBodyTable& table, std::size_t r, const Vec3& velocity, const Vec3& angular_velocity) {
    const Mat3& rotation = table.rotation[r];
    table.momentum[r] = table.mass[r] * velocity;
    table.angular_momentum[r] = rotation * table.moments[r].cwiseProduct(rotation.transpose() * angular_velocity);
}

Mat3 frame_of_mesh(const RigidBodyTable& table, std::size_t r) {
    return table.rotation[r] * table.axes[r].transpose();
}

/// Displacements and velocities of the nodes of an implicit body relative to the body's rigid motion, in the mesh
/// frame. Both are empty for a rigid body.
struct Deformation {
    std::span<Vec3> displacement, velocity;

    Deformation(Model& model, std::size_t body)
        : displacement(rows_of(model.implicit_nodes.displacement, model.bodies.implicit[body])),
          velocity(rows_of(model.implicit_nodes.velocity, model.bodies.implicit[body])) {}
    bool any() const { return !displacement.empty(); }
};

/// Updates RigidBodyTable::large, which marks bodies with large strain (StiffBody::becomes_large). The inertia of a
/// free body follows the deformed shape while the body has this mark. Must be called after node displacements or the
/// mass of a body have changed.
void note_strain(Model& model, std::size_t body) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const std::span<const Vec3> displacement = rows_of(model.implicit_nodes.displacement, model.bodies.implicit[body]);
    const bool held = model.is_held(body), was_large = table.large[r] != 0;
    const Vec3 momentum =
        held ? Vec3(Vec3::Zero()) : Vec3(frame_of_mesh(table, r).transpose() * table.angular_momentum[r]);
    const bool large = model.stiff_bodies[r].becomes_large(displacement, momentum);
    table.large[r] = large;
    if (!held && (large || was_large))
        follow_shape(displacement, large, frame_of_mesh(table, r), model.stiff_bodies[r], table.moments[r],
                     table.axes[r], table.rotation[r]);
}

void give_nodes_velocity(Model& model, std::size_t body) {
    const RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const Vec3 velocity = table.momentum[r] / table.mass[r], angular_velocity = spin(table, r);
    const Deformation deformation(model, body);
    const Mat3 from_mesh = frame_of_mesh(table, r);
    const Range nodes = model.bodies.nodes[body];
    for (Index n = nodes.begin; n < nodes.end; ++n) {
        model.nodes.velocity[n] = velocity + angular_velocity.cross(model.nodes.position[n] - table.center[r]);
        if (deformation.any())
            model.nodes.velocity[n] += from_mesh * deformation.velocity[static_cast<std::size_t>(n - nodes.begin)];
    }
}

/// Distributes the mass of a body among its nodes, so that sums over nodes give its mass and centre of mass
/// (Model::shares_mass). The mass of a node depends linearly on its position. It may be negative if the centre of mass
/// is far from the mean node position.
void share_mass(Model& model, std::size_t body) {
    const std::size_t r = rigid_row(model, body);
    const RigidBodyTable& table = model.rigid_bodies;
    const Range nodes = model.bodies.nodes[body];
    const std::span<const Vec3> rest = rows_of(std::as_const(model.nodes).rest_position, nodes);
    const Real count = static_cast<Real>(rest.size());
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : rest) middle += x / count;
    Mat3 spread = Mat3::Zero();
    for (const Vec3& x : rest) spread += (x - middle) * (x - middle).transpose() / count;
    const Vec3 slope = spread.ldlt().solve(table.rest_center[r] - middle);
    for (Index n = nodes.begin; n < nodes.end; ++n) {
        model.nodes.mass[n] = table.mass[r] / count * (1 + slope.dot(model.nodes.rest_position[n] - middle));
        if (model.nodes.inverse_mass[n] > 0)
            model.nodes.inverse_mass[n] = model.free_inverse_mass(static_cast<std::size_t>(n));
    }
}

}  // namespace

void append_rigid_body(Model& model, Index row, const NewBody& body) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = table.size();
    AnyTable(table).resize(r + 1);
    model.stiff_bodies.resize(r + 1);
    table.body[r] = row;
    table.holder[r] = no_index;
    table.large[r] = 0;
    const MassProperties found = mass_properties(model, body);
    write_masses(found, r, table);
    table.center[r] = body.position + body.rotation * found.center;
    table.rotation[r] = body.rotation * found.axes;
    set_motion(table, r, body.velocity, body.angular_velocity);
    const auto b = static_cast<std::size_t>(row);
    model.bodies.rigid[b] = {static_cast<Index>(r), static_cast<Index>(r) + 1};
    if (!model.shares_mass(b)) return;
    share_mass(model, b);
    give_nodes_velocity(model, b);
}

void keep_given_mass(const Model& model, std::size_t body, NewBody& as_new) {
    const RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const GivenMass given_mass = model.body_records[body].given_mass;
    if (given_mass == GivenMass::none) return;
    as_new.mass = table.mass[r];
    if (given_mass == GivenMass::mass) return;
    as_new.center_of_mass = table.rest_center[r];
    as_new.inertia = table.axes[r] * table.moments[r].asDiagonal() * table.axes[r].transpose();
}

void weigh_rigid_body(Model& model, std::size_t body, const NewBody& as_new) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const Vec3 velocity = table.momentum[r] / table.mass[r], angular_velocity = spin(table, r);
    const Mat3 from_mesh = frame_of_mesh(table, r);
    write_masses(mass_properties(model, as_new), r, table);
    table.rotation[r] = from_mesh * table.axes[r];
    set_motion(table, r, velocity, angular_velocity);
    if (model.shares_mass(body)) share_mass(model, body);
}

void follow_weight(Model& model, std::size_t body) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const Vec3 velocity = table.momentum[r] / table.mass[r], angular_velocity = spin(table, r);
    note_strain(model, body);
    set_motion(table, r, velocity, angular_velocity);
}

namespace {

/// The rigid motion that best maps the rest positions of nodes to given positions, in the sense of weighted least
/// squares.
struct NearestFrame {
    Vec3 center, rest_center;  // [m]
    Mat3 rotation;
};

/// Fits a rigid motion to the node positions of a body. `weight(n)`: weight of the node with local number n.
NearestFrame nearest_frame(std::span<const Vec3> rest_position, std::span<const Vec3> position, auto&& weight) {
    NearestFrame frame{Vec3::Zero(), Vec3::Zero(), Mat3::Identity()};
    Real mass = 0;
    for (std::size_t n = 0; n < position.size(); ++n) {
        mass += weight(n);
        frame.center += weight(n) * position[n];
        frame.rest_center += weight(n) * rest_position[n];
    }
    frame.center /= mass;
    frame.rest_center /= mass;
    Mat3 overlap = Mat3::Zero();
    for (std::size_t n = 0; n < position.size(); ++n)
        overlap += weight(n) * (position[n] - frame.center) * (rest_position[n] - frame.rest_center).transpose();
    const Eigen::JacobiSVD<Mat3> svd(overlap, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
    frame.rotation = u * svd.matrixV().transpose();
    return frame;
}

/// Fits a rigid motion to the node positions of a body, weighted with the masses of the nodes.
NearestFrame nearest_frame(const Model& model, std::size_t body, std::span<const Vec3> position) {
    const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    return nearest_frame(rows_of(model.nodes.rest_position, model.bodies.nodes[body]), position,
                         [&](std::size_t n) { return model.weight_of_node(first + n); });
}

}  // namespace

bool hold_whole(const Model& model, std::size_t body, std::span<const Index> nodes) {
    if (nodes.empty()) return false;
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[body]);
    const auto rest_position = [&](Index node) -> const Vec3& { return rest[static_cast<std::size_t>(node)]; };
    const Vec3 first = rest_position(nodes.front());
    Vec3 along = Vec3::Zero();
    for (const Index node : nodes)
        if ((rest_position(node) - first).squaredNorm() > along.squaredNorm()) along = rest_position(node) - first;
    // Nodes count as collinear if their distance from the line between the first node and the node farthest from it is
    // at most this fraction of the length of the line.
    constexpr Real thin = 1e-6;
    for (const Index node : nodes)
        if (along.cross(rest_position(node) - first).norm() > thin * along.squaredNorm()) return true;
    return false;
}

namespace {

/// Fits a rigid motion to the nodes that an attachment holds. `position`: positions of these nodes, in the order of the
/// attachment.
NearestFrame frame_of_held(const Model& model, std::size_t attachment, std::span<const Vec3> position) {
    std::vector<Vec3> rest;
    for (const Index node : rows_of(model.attachments.node, model.attachments.nodes[attachment]))
        rest.push_back(model.nodes.rest_position[static_cast<std::size_t>(node)]);
    return nearest_frame(rest, position, [](std::size_t) { return Real(1); });
}

/// Fits the frame of a held implicit body to the nodes of its attachment. Computes the displacements and velocities of
/// all nodes relative to this frame.
void write_held_shape(Model& model, std::size_t body) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const auto a = static_cast<std::size_t>(table.holder[r]);
    std::vector<Vec3> held;
    for (const Index node : rows_of(model.attachments.node, model.attachments.nodes[a]))
        held.push_back(model.nodes.position[static_cast<std::size_t>(node)]);
    const NearestFrame frame = frame_of_held(model, a, held);
    table.rotation[r] = frame.rotation * table.axes[r];
    table.center[r] = frame.center + frame.rotation * (table.rest_center[r] - frame.rest_center);
    table.momentum[r] = table.angular_momentum[r] = Vec3::Zero();
    const Mat3 to_mesh = frame_of_mesh(table, r).transpose();
    const Deformation deformation(model, body);
    auto n = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    for (std::size_t k = 0; k < deformation.displacement.size(); ++k, ++n) {
        deformation.displacement[k] =
            table.rest_center[r] + to_mesh * (model.nodes.position[n] - table.center[r]) - model.nodes.rest_position[n];
        deformation.velocity[k] = to_mesh * model.nodes.velocity[n];
    }
    note_strain(model, body);
}

}  // namespace

void follow_attachments(Model& model, std::size_t body) {
    model.stiff_bodies[rigid_row(model, body)].hold(rows_of(model.nodes.inverse_mass, model.bodies.nodes[body]));
    if (model.is_held(body)) {
        write_held_shape(model, body);
        return;
    }
    const auto copy_of = [&](auto& column) {
        const auto rows = rows_of(column, model.bodies.nodes[body]);
        return std::vector<Vec3>(rows.begin(), rows.end());
    };
    const std::vector<Vec3> position = copy_of(model.nodes.position), velocity = copy_of(model.nodes.velocity);
    set_deformed_shape(model, body, position);
    std::ranges::copy(velocity, rows_of(model.nodes.velocity, model.bodies.nodes[body]).begin());
    follow_node_velocities(model, body);
}

void find_holding_attachments(Model& model) {
    RigidBodyTable& table = model.rigid_bodies;
    if (table.size() == 0) return;
    const AttachmentTable& attachments = model.attachments;
    std::ranges::fill(table.holder, no_index);
    for (std::size_t a = 0; a < attachments.slot.size(); ++a) {
        const auto body = static_cast<std::size_t>(attachments.body[a]);
        const bool frame = model.dynamics_of(body) == BodyDynamics::implicit_elastic;
        if (frame || (model.is_rigid(body) && attachments.nodes[a].size() == model.bodies.nodes[body].size()))
            table.holder[rigid_row(model, body)] = static_cast<Index>(a);
    }
    for (std::size_t r = 0; r < table.size(); ++r) {
        if (table.holder[r] == no_index) continue;
        const auto a = static_cast<std::size_t>(table.holder[r]);
        const NearestFrame frame = frame_of_held(model, a, rows_of(attachments.anchor, attachments.nodes[a]));
        table.held_rotation[r] = frame.rotation;
        table.held_position[r] = frame.center - frame.rotation * frame.rest_center;
    }
}

RigidPose pose_of_body(const Model& model, std::size_t body) {
    if (model.has_frame(body)) {
        const RigidBodyTable& table = model.rigid_bodies;
        const std::size_t r = rigid_row(model, body);
        const Mat3 from_mesh = frame_of_mesh(table, r);
        return {table.center[r] - from_mesh * table.rest_center[r], from_mesh};
    }
    const NearestFrame frame = nearest_frame(model, body, rows_of(model.nodes.position, model.bodies.nodes[body]));
    return {frame.center - frame.rotation * frame.rest_center, frame.rotation};
}

RigidFit fit_rigid_body(const Model& model, std::size_t body, std::span<const Vec3> position) {
    const RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    const NearestFrame frame = nearest_frame(model, body, position);
    Real misfit = 0;
    for (std::size_t n = 0; n < position.size(); ++n)
        misfit = std::max(
            misfit,
            (frame.center + frame.rotation * (model.nodes.rest_position[first + n] - frame.rest_center) - position[n])
                .norm());
    const Vec3 center = frame.center + frame.rotation * (table.rest_center[r] - frame.rest_center);
    return {center, frame.rotation * table.axes[r], misfit};
}

void set_rigid_pose(Model& model, std::size_t body, const Vec3& center, const Mat3& rotation) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    table.center[r] = center;
    table.rotation[r] = rotation;
    const Mat3 from_mesh = frame_of_mesh(table, r);
    const Deformation deformation(model, body);
    const Range nodes = model.bodies.nodes[body];
    for (Index n = nodes.begin; n < nodes.end; ++n) {
        Vec3 shape = model.nodes.rest_position[n];
        if (deformation.any()) shape += deformation.displacement[static_cast<std::size_t>(n - nodes.begin)];
        model.nodes.position[n] = center + from_mesh * (shape - table.rest_center[r]);
    }
    give_nodes_velocity(model, body);
}

NodeMotion motion_of_nodes(const Model& model, std::size_t body, const Vec3& center) {
    NodeMotion motion;
    Mat3 second = Mat3::Zero();
    for (Index n = model.bodies.nodes[body].begin; n < model.bodies.nodes[body].end; ++n) {
        const Vec3 arm = model.nodes.position[n] - center;
        const Real mass = model.weight_of_node(static_cast<std::size_t>(n));
        motion.momentum += mass * model.nodes.velocity[n];
        motion.angular_momentum += mass * arm.cross(model.nodes.velocity[n]);
        second += mass * arm * arm.transpose();
    }
    motion.inertia = second.trace() * Mat3::Identity() - second;
    return motion;
}

void set_momenta(Model& model, std::size_t body, const Vec3& momentum, const Vec3& angular_momentum) {
    const std::size_t r = rigid_row(model, body);
    model.rigid_bodies.momentum[r] = momentum;
    model.rigid_bodies.angular_momentum[r] = angular_momentum;
    give_nodes_velocity(model, body);
}

void stop_rigid_body(Model& model, std::size_t body) {
    set_momenta(model, body, Vec3::Zero(), Vec3::Zero());
}

void set_deformed_shape(Model& model, std::size_t body, std::span<const Vec3> position) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const RigidFit fit = fit_rigid_body(model, body, position);
    table.center[r] = fit.center;
    table.rotation[r] = fit.rotation;
    const Mat3 to_mesh = frame_of_mesh(table, r).transpose();
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[body]);
    const Deformation deformation(model, body);
    for (std::size_t n = 0; n < position.size(); ++n)
        deformation.displacement[n] = table.rest_center[r] + to_mesh * (position[n] - fit.center) - rest[n];
    model.stiff_bodies[r].remove_rigid_motion(deformation.displacement);
    note_strain(model, body);
    std::ranges::copy(position, rows_of(model.nodes.position, model.bodies.nodes[body]).begin());
    give_nodes_velocity(model, body);
}

namespace {

/// Last part of follow_node_velocities() for bodies with large strain. The angular momentum is computed with the
/// inertia of the deformed body. The nodes keep their velocities up to rounding.
void follow_large_velocities(Model& model, std::size_t body, const Vec3& velocity) {
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    StiffBody& stiff = model.stiff_bodies[r];
    const Deformation deformation(model, body);
    const Mat3 from_mesh = frame_of_mesh(table, r);
    const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    stiff.set_shape({deformation.displacement, stiff.nodes()});
    std::vector<Vec3> by_stiff_row(stiff.size());
    const auto stiff_row = [&](std::size_t n) { return static_cast<std::size_t>(stiff.order_index(n)); };
    for (std::size_t n = 0; n < by_stiff_row.size(); ++n)
        by_stiff_row[stiff_row(n)] = from_mesh.transpose() * (model.nodes.velocity[first + n] - velocity);
    table.angular_momentum[r] = from_mesh * stiff.shape().angular_momentum(by_stiff_row);
    const Vec3 angular_velocity = from_mesh.transpose() * spin(table, r);
    for (std::size_t k = 0; k < by_stiff_row.size(); ++k)
        by_stiff_row[k] -= angular_velocity.cross(stiff.shape().position[k]);
    stiff.remove_momenta(by_stiff_row);
    for (std::size_t n = 0; n < by_stiff_row.size(); ++n) deformation.velocity[n] = by_stiff_row[stiff_row(n)];
    give_nodes_velocity(model, body);
}

/// Centre of mass of the nodes of a body, with the masses that Model::weight_of_node returns.
Vec3 middle_of_nodes(const Model& model, std::size_t body) {
    if (!model.shares_mass(body)) return model.rigid_bodies.center[rigid_row(model, body)];
    const std::span<const Vec3> position = rows_of(model.nodes.position, model.bodies.nodes[body]);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : position) middle += x / static_cast<Real>(position.size());
    return middle;
}

}  // namespace

void follow_node_velocities(Model& model, std::size_t body) {
    if (model.is_held(body)) {
        write_held_shape(model, body);
        return;
    }
    RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const Vec3 middle = middle_of_nodes(model, body);
    const NodeMotion motion = motion_of_nodes(model, body, middle);
    const Vec3 angular_velocity = motion.inertia.inverse() * motion.angular_momentum,
               velocity = motion.momentum / table.mass[r] + angular_velocity.cross(table.center[r] - middle);
    set_motion(table, r, velocity, angular_velocity);
    const Deformation deformation(model, body);
    if (deformation.any()) {
        note_strain(model, body);
        if (table.large[r]) {
            follow_large_velocities(model, body, velocity);
            return;
        }
        // note_strain() may have changed the moments of inertia to those of the undeformed body, so the angular
        // momentum is computed again.
        set_motion(table, r, velocity, angular_velocity);

        const Mat3 to_mesh = frame_of_mesh(table, r).transpose();
        const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
        for (std::size_t n = 0; n < deformation.velocity.size(); ++n)
            deformation.velocity[n] =
                to_mesh * (model.nodes.velocity[first + n] - velocity -
                           angular_velocity.cross(model.nodes.position[first + n] - table.center[r]));
        model.stiff_bodies[r].remove_rigid_motion(deformation.velocity);
    }
    give_nodes_velocity(model, body);
}

namespace {

/// Energies and momenta of a held body, summed over the nodes n for which counts(n) is true. RigidBodyTable has no
/// momentum of a held body, because the motion of its frame is prescribed. The elastic energy is always that of the
/// whole body.
RigidSums sums_of_nodes(const Model& model, std::size_t body, auto&& counts) {
    RigidSums sums;
    for (Index n = model.bodies.nodes[body].begin; n < model.bodies.nodes[body].end; ++n) {
        if (!counts(n)) continue;
        const Vec3 momentum = model.nodes.mass[n] * model.nodes.velocity[n];
        sums.kinetic += momentum.dot(model.nodes.velocity[n]) / 2;
        sums.momentum += momentum;
        sums.angular_momentum += model.nodes.position[n].cross(momentum);
    }
    const std::size_t r = rigid_row(model, body);
    sums.elastic = model.stiff_bodies[r].elastic_energy(
        rows_of(model.implicit_nodes.displacement, model.bodies.implicit[body]), model.rigid_bodies.large[r] != 0);
    return sums;
}

}  // namespace

RigidSums moving_sums(const Model& model, std::size_t body) {
    return sums_of_nodes(model, body, [&](Index n) { return model.nodes.inverse_mass[n] > 0; });
}

std::vector<Vec3> elastic_forces(const Model& model, std::size_t body) {
    const std::size_t r = rigid_row(model, body);
    const StiffBody& stiff = model.stiff_bodies[r];
    const std::span<const Vec3> displacement = rows_of(model.implicit_nodes.displacement, model.bodies.implicit[body]);
    std::vector<Vec3> by_stiff_row(displacement.size()), force(displacement.size());
    const auto stiff_row = [&](std::size_t n) { return static_cast<std::size_t>(stiff.order_index(n)); };
    for (std::size_t n = 0; n < displacement.size(); ++n) by_stiff_row[stiff_row(n)] = displacement[n];
    if (model.rigid_bodies.large[r])
        stiff.elements().forces(by_stiff_row, force);
    else
        stiff.elastic_forces(by_stiff_row, force);
    std::vector<Vec3> by_node(displacement.size());
    const Mat3 from_mesh = frame_of_mesh(model.rigid_bodies, r);
    for (std::size_t n = 0; n < by_node.size(); ++n) by_node[n] = -(from_mesh * force[stiff_row(n)]);
    return by_node;
}

RigidSums rigid_sums(const Model& model, std::size_t body) {
    if (!model.has_frame(body)) return {};
    if (model.is_held(body) && !model.is_rigid(body)) return sums_of_nodes(model, body, [](Index) { return true; });
    const RigidBodyTable& table = model.rigid_bodies;
    const std::size_t r = rigid_row(model, body);
    const Vec3 &momentum = table.momentum[r], &angular = table.angular_momentum[r];
    RigidSums sums{(momentum.squaredNorm() / table.mass[r] + angular.dot(spin(table, r))) / 2, 0, momentum,
                   angular + table.center[r].cross(momentum)};
    const Range rows = model.bodies.implicit[body];
    if (rows.size() == 0) return sums;
    const std::span<const Vec3> velocity = rows_of(model.implicit_nodes.velocity, rows);
    const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    for (std::size_t n = 0; n < velocity.size(); ++n)
        sums.kinetic += model.nodes.mass[first + n] * velocity[n].squaredNorm() / 2;
    sums.elastic =
        model.stiff_bodies[r].elastic_energy(rows_of(model.implicit_nodes.displacement, rows), table.large[r] != 0);
    return sums;
}

}  // namespace skerry
