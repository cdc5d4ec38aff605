#include "systems/dynamics/implicit/free_large_step.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

#include "systems/dynamics/implicit/solve_large_step.h"
#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/geometry/rotation.h"

namespace skerry {

bool kick_large_free_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                          std::size_t r, Real h, Real theta, StiffBody& stiff, std::span<Vec3> out) {
    const BodyRows body(bodies, stiff, r);
    LargeStep& step = stiff.large_step;
    step.resize(body.count);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement), velocity = body.rows(bodies.velocity);
    for (std::size_t n = 0; n < body.count; ++n) step.unmoved_displacement[body.order_index(n)] = displacement[n];
    stiff.set_shape(step.unmoved_displacement);
    const Real theta_h = theta * h;
    const Mat3 to_mesh = bodies.turn(r).transpose();
    step.angular_momentum = to_mesh * spins.kicked(r);
    // In a step of length h, Coriolis forces rotate the node velocities by the rotation vector -2 h omega, where omega
    // is the angular velocity of the frame. The exact rotation is applied, because it adds no energy.
    const Mat3 coriolis_rotation =
        rotation_matrix(-2 * h * stiff.shape().inertia().ldlt().solve(step.angular_momentum));
    for (std::size_t n = 0; n < body.count; ++n)
        step.velocity_before[body.order_index(n)] = coriolis_rotation * velocity[n];
    stiff.remove_momenta(step.velocity_before);
    step.velocity = step.velocity_before;
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        step.impulse[k] = stiff.mass(k) * step.velocity_before[k];
        if (!loads.load.empty()) step.impulse[k] += theta_h * (to_mesh * loads.load[body.first_node + n]);
    }
    if (!solve_large_step(inertia_of(bodies, r, theta_h), theta_h, stiff)) return false;
    std::ranges::copy(step.velocity, out.begin());
    return true;
}

namespace {

/// Removes rigid motion from the velocities and displacements at the end of the step. Writes the principal moments and
/// axes of inertia of the new shape, and whether its strain is large.
///
/// Returns the damped energy [J]: `energy` minus the kinetic energy of the deformation at the end of the step, and
/// minus the growth of the spin energy and of the elastic energy. `energy`: kinetic energy of the deformation at the
/// start of the step plus the work done on the body [J].
Real end_in_shape(const ImplicitBodies& bodies, const ImplicitSpins& spins, std::size_t r, Real h, Real energy,
                  StiffBody& stiff, const ImplicitStrains& out) {
    const BodyRows body(bodies, stiff, r);
    const std::span<Vec3> next = body.rows(out.velocity_next), displacement_next = body.rows(out.displacement_next);
    const std::span<const Vec3> displacement = body.rows(bodies.displacement);
    const Mat3 from_mesh = bodies.turn(r), to_mesh = from_mesh.transpose();
    LargeStep& step = stiff.large_step;
    const bool was_large = bodies.large[r] != 0;
    const Mat3 turned = stiff.rotate_to_own_frame(displacement_next);
    const Vec3 momentum = spins.after(r);
    const bool is_large =
        is_large_after(was_large, displacement_next, turned.transpose() * (to_mesh * momentum), body, stiff);
    out.large_next[r] = is_large;
    follow_shape(displacement_next, is_large, from_mesh * turned, stiff, out.moments_next[r], out.axes_next[r],
                 out.rotation_shaped[r]);
    // Removes rigid-body motion from the velocities. The lever arms of the nodes are those of the shape at the end of
    // the step if strain is large, else those of the rest shape.
    for (Vec3& of_node : next) of_node = turned.transpose() * of_node;
    if (is_large) {
        step.velocity_before.resize(body.count);
        for (std::size_t n = 0; n < body.count; ++n) step.velocity_before[body.order_index(n)] = next[n];
        stiff.set_shape({displacement_next, stiff.nodes()});
        stiff.remove_momenta(step.velocity_before);
        for (std::size_t n = 0; n < body.count; ++n) next[n] = step.velocity_before[body.order_index(n)];
    } else {
        stiff.remove_rigid_motion(next);
    }
    for (std::size_t n = 0; n < body.count; ++n) energy -= stiff.mass(body.order_index(n)) / 2 * next[n].squaredNorm();
    // Subtracts the growth of the spin energy L.omega / 2, with the angular momentum L and the angular velocity omega.
    // At the end of the step omega follows from the new shape and the rotation of turn_of_step(), so the growth
    // includes the energy error of this rotation (docs/methods/rigid_bodies.md 2).
    const Mat3 turned_for_step =
        turn_of_step(out.rotation_shaped[r], out.moments_next[r], momentum, spins.push_spin[r], h);
    const Vec3 spin_before = spin_of(bodies.rotation[r], spins.moments[r], momentum),
               spin_after = spin_of(turned_for_step, out.moments_next[r], momentum);
    energy += momentum.dot(spin_before - spin_after) / 2;
    return energy + stiff.elastic_energy(displacement, was_large) - stiff.elastic_energy(displacement_next, is_large);
}

}  // namespace

Real end_large_free_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                         std::size_t r, Real h, Real theta, StiffBody& stiff, const ImplicitStrains& out) {
    const BodyRows body(bodies, stiff, r);
    const std::span<Vec3> next = body.rows(out.velocity_next);
    const std::span<const Vec3> velocity = body.rows(bodies.velocity), contact = body.rows(out.contact_impulse);
    const Mat3 to_mesh = bodies.turn(r).transpose();
    LargeStep& step = stiff.large_step;
    const bool newton = stiff.is_tangent();
    Real energy = 0;
    for (std::size_t n = 0; n < body.count; ++n) {
        const std::size_t k = body.order_index(n);
        const Vec3 during = next[n], before = newton ? step.velocity_before[k] : velocity[n];
        next[n] = before + (during - before) / theta;
        // `energy`: work of contacts and loads, computed as in the energy balance that the engine reports, plus the
        // kinetic energy of the deformation at the start of the step [J].
        energy += (to_mesh * contact[n]).dot(velocity[n] + during) / 2;
        if (!loads.load.empty()) {
            const Vec3 load = to_mesh * loads.load[body.first_node + n];
            energy += h * load.dot(during - (next[n] - velocity[n]) / 2) + (loads.kick - h) * load.dot(velocity[n]);
        }
        energy += stiff.mass(k) / 2 * velocity[n].squaredNorm();
    }
    return end_in_shape(bodies, spins, r, h, energy, stiff, out);
}

Real become_large(const ImplicitBodies& bodies, const ImplicitSpins& spins, std::size_t r, Real h, StiffBody& stiff,
                  const ImplicitStrains& out) {
    const BodyRows body(bodies, stiff, r);
    Real kinetic = 0;
    for (std::size_t n = 0; n < body.count; ++n)
        kinetic += stiff.mass(body.order_index(n)) / 2 * body.rows(out.velocity_next)[n].squaredNorm();
    // Growth of the elastic energy in the step by linear elasticity [J]. The damped energy that the time integration
    // dissipates has been computed with this growth. end_in_shape() subtracts the growth by the material laws from its
    // argument, so the linear growth is added there: the sum corrects the damped energy.
    const Real linear = stiff.elastic_energy(body.rows(out.displacement_next), false) -
                        stiff.elastic_energy(body.rows(bodies.displacement), false);
    return end_in_shape(bodies, spins, r, h, kinetic + linear, stiff, out);
}

void follow_shape(std::span<const Vec3> displacement, bool large, const Mat3& from_mesh, StiffBody& stiff,
                  Vec3& moments, Mat3& axes, Mat3& rotation) {
    BodyShape& shape = stiff.large_step.shape;
    std::vector<Vec3>& rest = stiff.large_step.displacement_in_step;
    if (!large) rest.assign(stiff.size(), Vec3::Zero());
    stiff.find_shape(large ? Displacements(displacement, stiff.nodes()) : Displacements(rest), shape);
    const PrincipalInertia principal(shape.inertia());
    moments = principal.moments;
    axes = principal.axes;
    rotation = from_mesh * axes;
}

}  // namespace skerry
