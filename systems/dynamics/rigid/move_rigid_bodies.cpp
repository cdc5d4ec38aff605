#include "systems/dynamics/rigid/move_rigid_bodies.h"

#include <Eigen/Geometry>

#include "jobs/parallel_for.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

namespace {

/// Velocity field of a rigid body.
struct RigidField {
    Vec3 center, velocity, spin;  // [m], [m/s], [rad/s]

    Vec3 at(const Vec3& position) const { return velocity + spin.cross(position - center); }
};

/// Maps rest positions of the nodes of a rigid body to world positions.
struct RestToWorld {
    Vec3 center, rest_center;
    Mat3 from_mesh;

    RestToWorld(const RigidBodies& bodies, std::size_t r, const Vec3& at, const Mat3& rotation, const Mat3& axes)
        : center(at), rest_center(bodies.rest_center[r]), from_mesh(rotation * axes.transpose()) {}
    Vec3 of(const Vec3& rest_position) const { return center + from_mesh * (rest_position - rest_center); }
};

void for_each_node(Range nodes, auto&& visit) {
    for (auto n = static_cast<std::size_t>(nodes.begin); n < static_cast<std::size_t>(nodes.end); ++n) visit(n);
}

void for_each_body(Executor& executor, const RigidBodies& bodies, auto&& visit) {
    parallel_for(executor, bodies.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) visit(r);
    });
}

/// Shape of a body at the end of the step in the frame of its mesh: deformed for an implicit body, at rest for a rigid
/// body.
struct ShapeNext {
    const RigidBodies& bodies;
    const ElasticMotion& elastic;
    Index first_row;  // first row of ImplicitNodeTable; no_index for a rigid body
    std::size_t first_node;

    ShapeNext(const RigidBodies& of, const ElasticMotion& motion, std::size_t r)
        : bodies(of),
          elastic(motion),
          first_row(of.implicit(r).size() > 0 ? of.implicit(r).begin : no_index),
          first_node(static_cast<std::size_t>(of.nodes(r).begin)) {}

    const Vec3& moments(std::size_t r) const { return deforms() ? elastic.moments[r] : bodies.moments[r]; }
    const Mat3& axes(std::size_t r) const { return deforms() ? elastic.axes[r] : bodies.axes[r]; }
    const Mat3& rotation(std::size_t r) const { return deforms() ? elastic.rotation[r] : bodies.rotation[r]; }
    bool deforms() const { return first_row != no_index; }
    std::size_t row(std::size_t n) const { return static_cast<std::size_t>(first_row) + (n - first_node); }
    Vec3 at(std::size_t n) const {
        return deforms() ? Vec3(bodies.rest_position[n] + elastic.displacement[row(n)]) : bodies.rest_position[n];
    }
};

bool is_moved(const RigidImpulses& impulses, std::size_t r) {
    return !impulses.contact_impulse[r].isZero(0) || !impulses.contact_moment[r].isZero(0) ||
           !impulses.push_velocity[r].isZero(0) || !impulses.push_spin[r].isZero(0);
}

Vec3 momentum_after(const RigidBodies& bodies, const RigidImpulses& impulses, std::size_t r) {
    return bodies.momentum[r] + (impulses.kick[r] + impulses.contact_impulse[r]);
}
Vec3 angular_momentum_after(const RigidBodies& bodies, const RigidImpulses& impulses, std::size_t r) {
    return bodies.angular_momentum[r] + (impulses.moment_kick[r] + impulses.contact_moment[r]);
}

}  // namespace

bool kick_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidHolds& holds,
                       const RigidForces& forces, Real h, Real kick, const RigidKicks& out) {
    if (bodies.size() == 0) return false;
    for_each_body(executor, bodies, [&](std::size_t r) {
        out.contact_impulse[r] = out.contact_moment[r] = out.push_velocity[r] = out.push_spin[r] = Vec3::Zero();
        out.inverse_inertia[r] = inverse_inertia_of(bodies.rotation[r], bodies.moments[r]);
        out.kick[r] = out.moment_kick[r] = Vec3::Zero();
        if (bodies.is_led_frame(r)) {
            out.inverse_inertia[r] = Mat3::Zero();
            return;
        }
        if (bodies.asleep(r)) return;
        if (holds.hold(r)) {
            const HeldPose end(holds, r, h, bodies.rest_center[r], bodies.axes[r]);
            const Mat3 inertia = end.rotation * bodies.moments[r].asDiagonal() * end.rotation.transpose();
            out.kick[r] = bodies.mass[r] / h * (end.center - bodies.center[r]) - bodies.momentum[r];
            out.moment_kick[r] = inertia * holds.motion_of(r).angular_velocity - bodies.angular_momentum[r];
            return;
        }
        Vec3 force = bodies.mass[r] * forces.gravity, moment = Vec3::Zero();
        if (!forces.load.empty())
            for_each_node(bodies.nodes(r), [&](std::size_t n) {
                force += forces.load[n];
                moment += (forces.position[n] - bodies.center[r]).cross(forces.load[n]);
            });
        const Real seconds = bodies.implicit(r).size() > 0 ? h : kick;
        out.kick[r] = seconds * force;
        out.moment_kick[r] = seconds * moment;
        const RigidField field{bodies.center[r], (bodies.momentum[r] + out.kick[r]) / bodies.mass[r],
                               out.inverse_inertia[r] * (bodies.angular_momentum[r] + out.moment_kick[r])};
        for_each_node(bodies.step_nodes(r),
                      [&](std::size_t n) { out.velocity_next[n] = field.at(forces.position[n]); });
    });
    return true;
}

bool turn_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidHolds& holds,
                       const RigidImpulses& impulses, const ElasticMotion& elastic, std::span<const Vec3> position,
                       Real h, const RigidTurns& out) {
    if (bodies.size() == 0) return false;
    for_each_body(executor, bodies, [&](std::size_t r) {
        out.center_next[r] = bodies.center[r];
        out.rotation_next[r] = bodies.rotation[r];
        if (bodies.asleep(r) && !is_moved(impulses, r)) return;
        const ShapeNext shape(bodies, elastic, r);
        if (holds.hold(r)) {
            const HeldPose end(holds, r, h, bodies.rest_center[r], bodies.axes[r]);
            out.center_next[r] = end.center;
            out.rotation_next[r] = without_strain(end.rotation);
        } else {
            out.center_next[r] +=
                h * (momentum_after(bodies, impulses, r) / bodies.mass[r] + impulses.push_velocity[r]);
            out.rotation_next[r] = turn_of_step(shape.rotation(r), shape.moments(r),
                                                angular_momentum_after(bodies, impulses, r), impulses.push_spin[r], h);
        }
        const RestToWorld pose(bodies, r, out.center_next[r], out.rotation_next[r], shape.axes(r));
        for_each_node(bodies.step_nodes(r),
                      [&](std::size_t n) { out.velocity_next[n] = (pose.of(shape.at(n)) - position[n]) / h; });
    });
    return true;
}

bool move_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidImpulses& impulses,
                       const ElasticMotion& elastic, std::span<const Vec3> center_next,
                       std::span<const Mat3> rotation_next, bool draws_late, const RigidMoves& out) {
    if (bodies.size() == 0) return false;
    for_each_body(executor, bodies, [&](std::size_t r) {
        if (bodies.asleep(r)) return;
        const Vec3 momentum = momentum_after(bodies, impulses, r);
        const Vec3 angular_momentum = angular_momentum_after(bodies, impulses, r);
        const ShapeNext shape(bodies, elastic, r);
        const RestToWorld pose(bodies, r, center_next[r], rotation_next[r], shape.axes(r));
        const RigidField field{center_next[r], momentum / bodies.mass[r],
                               spin_of(rotation_next[r], shape.moments(r), angular_momentum)};
        out.center[r] = center_next[r];
        out.rotation[r] = rotation_next[r];
        const bool led = bodies.is_led_frame(r);
        out.momentum[r] = led ? Vec3(Vec3::Zero()) : momentum;
        out.angular_momentum[r] = led ? Vec3(Vec3::Zero()) : angular_momentum;
        if (shape.deforms()) {
            out.large[r] = elastic.large[r];
            out.moments[r] = elastic.moments[r];
            out.axes[r] = elastic.axes[r];
        }
        for_each_node(draws_late ? bodies.step_nodes(r) : bodies.nodes(r), [&](std::size_t n) {
            out.position[n] = pose.of(shape.at(n));
            if (!shape.deforms()) {
                out.velocity[n] = field.at(out.position[n]);
                return;
            }
            const std::size_t row = shape.row(n);
            out.displacement[row] = elastic.displacement[row];
            out.displacement_velocity[row] = elastic.velocity[row];
            const Vec3 deforming = pose.from_mesh * elastic.velocity[row];
            if (!led)
                out.velocity[n] = field.at(out.position[n]) + deforming;
            else if (bodies.inverse_mass[n] > 0)  // held nodes already have their prescribed velocity
                out.velocity[n] = deforming;
        });
    });
    return true;
}

void draw_round_bodies(Executor& executor, const RigidBodies& bodies, bool resting, std::span<Vec3> position,
                       std::span<Vec3> velocity) {
    for_each_body(executor, bodies, [&](std::size_t r) {
        const Range drawn{bodies.step_nodes(r).end, bodies.nodes(r).end};
        if (drawn.size() == 0 || (bodies.asleep(r) && !resting)) return;
        const RestToWorld pose(bodies, r, bodies.center[r], bodies.rotation[r], bodies.axes[r]);
        const RigidField field{bodies.center[r], bodies.momentum[r] / bodies.mass[r],
                               spin_of(bodies.rotation[r], bodies.moments[r], bodies.angular_momentum[r])};
        for_each_node(drawn, [&](std::size_t n) {
            position[n] = pose.of(bodies.rest_position[n]);
            velocity[n] = field.at(position[n]);
        });
    });
}

}  // namespace skerry
