#include "systems/dynamics/implicit/held_implicit_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "systems/dynamics/implicit/solve_large_step.h"

namespace skerry {

namespace {

/// Access to the nodes of a body whose frame an attachment holds, by index n in the body. The attachment holds only
/// some of the nodes.
struct HeldNodes {
    const ImplicitBodies& bodies;
    const HeldFrame& frame;
    Vec3 rest_center;
    std::size_t first_node;

    HeldNodes(const ImplicitBodies& implicit_bodies, const HeldFrame& held_frame, std::size_t r)
        : bodies(implicit_bodies),
          frame(held_frame),
          rest_center(implicit_bodies.rest_center[r]),
          first_node(static_cast<std::size_t>(implicit_bodies.nodes(r).begin)) {}

    bool held(std::size_t n) const { return !(bodies.inverse_mass[first_node + n] > 0); }
    Vec3 arm(std::size_t n) const { return bodies.rest_position[first_node + n] - rest_center; }
    /// Prescribed velocity of a held node, in the frame of the mesh at the end of the step [m/s].
    Vec3 prescribed_velocity(std::size_t n) const {
        return frame.turn.transpose() * bodies.node_velocity[first_node + n];
    }
};

}  // namespace

HeldFrame::HeldFrame(const ImplicitBodies& bodies, std::size_t r, Real h) : is_still(true), shift(Vec3::Zero()) {
    turn_start = turn = bodies.turn(r);
    across = Mat3::Identity();
    if (bodies.asleep(r)) return;
    const HeldPose end(bodies.holds, r, h, bodies.rest_center[r], bodies.axes[r]);
    const Mat3 rotation = without_strain(end.rotation);
    if (end.center == bodies.center[r] && rotation == bodies.rotation[r]) return;
    is_still = false;
    turn = rotation * bodies.axes[r].transpose();
    across = turn.transpose() * turn_start;
    shift = turn.transpose() * (bodies.center[r] - end.center);
}

namespace {

/// True if a step with the given velocities leads to large strain. `velocity`: by index in the elimination order, in
/// the frame of the mesh at the end of the step.
bool becomes_large(const HeldNodes& nodes, const BodyRows& body, std::span<const Vec3> displacement,
                   std::span<const Vec3> velocity, Real h, StiffBody& stiff) {
    if (!stiff.elements().any_nonlinear()) return false;
    std::vector<Vec3>& at_end = stiff.large_step.displacement_in_step;
    at_end.resize(body.count);
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        at_end[k] = nodes.frame.carried(nodes.arm(n), displacement[n]) +
                    h * (nodes.held(n) ? nodes.prescribed_velocity(n) : velocity[k]);
    }
    return stiff.becomes_large_in_order(at_end, Vec3::Zero());
}

/// Computes the node velocities of a step at large strain by Newton's method, in the frame of the mesh at the end of
/// the step, by index in the elimination order. `outer_force(n)`: force on node n in this frame [N]. Returns false if
/// Newton's method fails.
bool kick_large(const HeldNodes& nodes, const BodyRows& body, std::size_t r, Real theta_h, auto&& outer_force,
                StiffBody& stiff, std::span<Vec3> out) {
    LargeStep& step = stiff.large_step;
    step.resize(body.count);
    const std::span<const Vec3> displacement = body.rows(nodes.bodies.displacement),
                                velocity = body.rows(nodes.bodies.velocity);
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        const Vec3 before = nodes.frame.across * velocity[n];
        step.unmoved_displacement[k] = nodes.frame.carried(nodes.arm(n), displacement[n]);
        step.velocity[k] = nodes.held(n) ? nodes.prescribed_velocity(n) : before;
        step.impulse[k] = stiff.mass(k) * before + theta_h * outer_force(n);
    }
    if (!solve_large_step(inertia_of(nodes.bodies, r, theta_h), theta_h, stiff)) return false;
    std::ranges::copy(step.velocity, out.begin());
    return true;
}

}  // namespace

void kick_held_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real h, Real theta,
                    StiffBody& stiff, const ImplicitKicks& out) {
    const BodyRows body(bodies, stiff, r);
    const HeldFrame frame(bodies, r, h);
    const HeldNodes nodes(bodies, frame, r);
    const std::span<Vec3> impulse = body.rows(out.impulse), force = body.rows(out.elastic_force),
                          next = body.rows(out.velocity_next);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement), velocity = body.rows(bodies.velocity);
    const auto outer_force = [&](std::size_t n) {
        Vec3 outer = stiff.mass(body.order_index(n)) * loads.gravity;
        if (!loads.load.empty()) outer += loads.load[body.first_node + n];
        return Vec3(frame.turn.transpose() * outer);
    };
    // `force`: elastic forces in the step if free nodes do not move in the world. They are (1 - theta) times the forces
    // at the start of the step plus theta times those at its end. These differ only if the frame or a held node moves
    // (`carried`).
    bool carried = !frame.is_still;
    for (std::size_t n = 0; n < body.count; ++n) {
        impulse[body.order_index(n)] = displacement[n];
        carried |= nodes.held(n) && !bodies.node_velocity[body.first_node + n].isZero(0);
    }
    bool large = bodies.large[r] != 0, sound = true;
    if (!large) {
        stiff.elastic_forces(impulse, force);
        if (carried) {
            for (std::size_t n = 0; n < body.count; ++n) {
                Vec3& at_end = impulse[body.order_index(n)];
                at_end = frame.carried(nodes.arm(n), displacement[n]);
                if (nodes.held(n)) at_end += h * nodes.prescribed_velocity(n);
            }
            // `next` temporarily holds forces, by index in the elimination order
            stiff.elastic_forces(impulse, next);
            for (std::size_t k = 0; k < body.count; ++k)
                force[k] = (1 - theta) * (frame.across * force[k]) + theta * next[k];
        }
        for (std::size_t n = 0; n < body.count; ++n) {
            const std::size_t k = body.order_index(n);
            impulse[k] = stiff.mass(k) * (frame.across * velocity[n]) + theta * h * (outer_force(n) - force[k]);
        }
        sound = make_factor(bodies, r, h, theta, stiff);
        if (sound) stiff.respond(impulse);
        large = sound && becomes_large(nodes, body, displacement, impulse, h, stiff);
    }
    if (large) sound = kick_large(nodes, body, r, theta * h, outer_force, stiff, impulse);
    if (!sound)  // velocities of NaN make the engine refuse the step
        std::ranges::fill(impulse, Vec3::Constant(std::numeric_limits<Real>::quiet_NaN()));
    for (std::size_t n = 0; n < body.count; ++n) {
        if (nodes.held(n)) {
            next[n] = frame.turn_start.transpose() * bodies.node_velocity[body.first_node + n];
            continue;
        }
        const Vec3& in_end = impulse[body.order_index(n)];
        next[n] = frame.across.transpose() * in_end;
        out.node_velocity_next[body.first_node + n] = frame.turn * in_end;
    }
}

namespace {

/// Computes the elastic forces on the nodes in a step of large strain, by index in the elimination order [N].
/// - Free nodes: forces follow from the change of momentum.
/// - Held nodes: forces follow from the material laws, and each node gets an equal share of the force that is missing
///   to the sum zero.
///
/// The missing force has two causes: Newton's method leaves a residual, and the motion by contacts is computed with the
/// tangent matrix instead of the laws.
void forces_of_large_step(const HeldNodes& nodes, const BodyRows& body, Real inertia, Real theta, Real theta_h,
                          std::span<const Vec3> next, std::span<const Vec3> contact, StiffBody& stiff,
                          std::span<Vec3> force) {
    LargeStep& step = stiff.large_step;
    const Mat3 to_mesh = nodes.frame.turn.transpose();
    for (std::size_t n = 0; n < body.count; ++n)
        step.displacement_in_step[body.order_index(n)] =
            step.unmoved_displacement[body.order_index(n)] + theta_h * next[n];
    stiff.elements().forces(step.displacement_in_step, force);
    Vec3 missing = Vec3::Zero();
    Real held = 0;
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        held += nodes.held(n);
        if (!nodes.held(n))
            force[k] = (step.impulse[k] - inertia * stiff.mass(k) * next[n] + theta * (to_mesh * contact[n])) / theta_h;
        missing -= force[k];
    }
    for (std::size_t n = 0; n < body.count; ++n)
        if (nodes.held(n)) force[body.order_index(n)] += missing / held;
}

}  // namespace

Real strain_held_body(const ImplicitBodies& bodies, std::size_t r, Real h, Real kick, Real theta, StiffBody& stiff,
                      const ImplicitStrains& out) {
    const BodyRows body(bodies, stiff, r);
    const HeldFrame frame(bodies, r, h);
    const HeldNodes nodes(bodies, frame, r);
    const std::span<Vec3> impulse = body.rows(out.impulse), rate = body.rows(out.force_rate),
                          next = body.rows(out.velocity_next), displacement_next = body.rows(out.displacement_next);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement), velocity = body.rows(bodies.velocity),
                                force = body.rows(out.elastic_force), contact = body.rows(out.contact_impulse);
    const Mat3 to_mesh = frame.turn.transpose();
    out.hold_moment[r] = Vec3::Zero();
    // From here on, velocities are in the frame of the mesh at the end of the step.
    const bool any_contact = std::ranges::any_of(contact, [](const Vec3& of_node) { return !of_node.isZero(0); });
    if (any_contact) {
        for (std::size_t n = 0; n < body.count; ++n) impulse[body.order_index(n)] = theta * (to_mesh * contact[n]);
        stiff.respond(impulse);
    }
    for (std::size_t n = 0; n < body.count; ++n) {
        next[n] = nodes.held(n) && !bodies.asleep(r) ? nodes.prescribed_velocity(n) : Vec3(frame.across * next[n]);
        if (any_contact) next[n] += impulse[body.order_index(n)];
        displacement_next[n] = frame.carried(nodes.arm(n), displacement[n]) + h * next[n];
    }
    if (bodies.asleep(r)) return 0;
    // With the lever arms of the deformed shape, the elastic forces have a moment about the centre. The attachment
    // balances this moment by the angular impulse hold_moment.
    const bool newton = stiff.is_tangent(), was_large = bodies.large[r] != 0,
               is_large = is_large_after(was_large, displacement_next, Vec3::Zero(), body, stiff);
    const bool large = newton || was_large || is_large;
    out.large_next[r] = is_large;
    if (newton) {
        forces_of_large_step(nodes, body, inertia_of(bodies, r, theta * h), theta, theta * h, next, contact, stiff,
                             rate);
    } else {
        for (std::size_t n = 0; n < body.count; ++n)
            impulse[body.order_index(n)] = nodes.held(n) ? Vec3(Vec3::Zero()) : Vec3(next[n]);
        stiff.elastic_forces(impulse, rate);
        for (std::size_t k = 0; k < body.count; ++k) rate[k] = force[k] + theta * h * rate[k];
    }
    Vec3 moment = Vec3::Zero();
    Real damped = 0;  // damped energy [J]
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        const Vec3 &mesh_force = rate[k], world_force = frame.turn * mesh_force;
        const Vec3 arm = nodes.arm(n) + displacement[n];
        moment += (frame.turn_start * arm).cross(world_force);
        // The attachment rotates the node positions against the elastic forces. (Its translation does no work, because
        // these forces add up to zero.)
        // - At small strain, the work of the attachment is subtracted.
        // - At large strain, the complete work of the nodes against the elastic forces is added, without the work of
        //   the attachment. The growth of the elastic energy is subtracted below.
        if (large)
            damped += h * next[n].dot(mesh_force);
        else if (!frame.is_still)
            damped += mesh_force.dot(arm - frame.across * arm);
        // Force on a held node over the complete step, reported as a force that acts for the time `kick`.
        if (Vec3& force_on_held = out.force[body.first_node + n]; nodes.held(n))
            force_on_held = h / kick * (force_on_held - world_force);
    }
    out.hold_moment[r] = -h * moment;
    // Adds the energy losses (theta - 1/2) (dw.M dw + du.K du) and the material damping, with the changes dw of
    // velocity and du of displacement in the step, the masses M and the stiffness K. At large strain the decrease of
    // the elastic energy replaces the term du.K du.
    if (large) {
        damped += stiff.elastic_energy(displacement, was_large) - stiff.elastic_energy(displacement_next, is_large);
    } else {
        for (std::size_t n = 0; n < body.count; ++n)
            impulse[body.order_index(n)] = displacement_next[n] - displacement[n];
        stiff.elastic_forces(impulse, rate);
    }
    const Real lossy = theta - 0.5, damping = bodies.damping(r);
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        if (!large) damped += lossy * impulse[k].dot(rate[k]);
        if (nodes.held(n)) continue;
        const Vec3 before = frame.across * velocity[n], during = next[n], change = (during - before) / theta;
        damped += stiff.mass(k) * (lossy * change.squaredNorm() + h * damping * during.squaredNorm());
        // The reported work of contacts uses the mean of the velocities `before` and `during`, while the losses above
        // assume `during`. The difference is added here.
        damped += (to_mesh * contact[n]).dot(before - during) / 2;
        next[n] = before + change;
    }
    return damped;
}

void drift_held_body(const ImplicitBodies& bodies, std::size_t r, Real seconds, std::span<Vec3> displacement_next,
                     std::span<Vec3> velocity_next) {
    const HeldFrame frame(bodies, r, seconds);
    const HeldNodes nodes(bodies, frame, r);
    const auto first = static_cast<std::size_t>(bodies.rows(r).begin);
    for (std::size_t n = 0; n < static_cast<std::size_t>(bodies.rows(r).size()); ++n) {
        velocity_next[first + n] =
            nodes.held(n) ? nodes.prescribed_velocity(n) : Vec3(frame.across * bodies.velocity[first + n]);
        displacement_next[first + n] =
            frame.carried(nodes.arm(n), bodies.displacement[first + n]) + seconds * velocity_next[first + n];
    }
}

}  // namespace skerry
