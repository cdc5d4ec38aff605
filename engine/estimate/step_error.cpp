#include "engine/estimate/step_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/world_state.h"
#include "systems/geometry/rotation.h"

namespace skerry {

/// Frame relative to which a body deforms: that of an attachment that holds the body, else that of its mesh.
struct StepError::Frame {
    RigidPose pose;
    Vec3 center;  // point of the frame that moves with motion.velocity [m]
    Twist motion;
};

/// The steps between two samples.
struct StepError::Interval {
    Real seconds;                   // duration [s]
    Real step;                      // mean length of the steps [s]
    std::set<BodyHandle> collided;  // bodies that began or ceased to touch another body
    bool rebounds;                  // true if contacts have restitution
};

namespace {

// Displacements of a body below this multiple of its mean edge length count as rest.
constexpr Real least_motion = 1e-6;

const Model& model_of(const World& world) {
    return WorldAccess::state_of(world).model;
}

std::size_t row_of(const World& world, BodyHandle body) {
    return static_cast<std::size_t>(model_of(world).row(body, "sample"));
}

Real dissipated_by(const World& world) {
    return WorldAccess::state_of(world).record.counters.dissipated;
}

/// Root mean square length of vectors at the nodes of a body, weighted by mass. of_node(n) returns the vector of node n
/// of the body.
Real mean_size(const World& world, BodyHandle body, auto&& of_node) {
    const Model& model = model_of(world);
    const Range nodes = model.bodies.nodes[row_of(world, body)];
    Real sum = 0, mass = 0;
    for (Index n = nodes.begin; n < nodes.end; ++n) {
        const Real weight = model.weight_of_node(static_cast<std::size_t>(n));
        const Vec3 value = of_node(static_cast<std::size_t>(n - nodes.begin));
        sum += weight * value.squaredNorm();
        mass += weight;
    }
    return std::sqrt(sum / mass);
}

Real size_of(const World& world, BodyHandle body, std::span<const Vec3> of_node) {
    return mean_size(world, body, [&](std::size_t n) { return of_node[n]; });
}

Real elastic_energy_of(const World& world, BodyHandle body) {
    const Model& model = model_of(world);
    const std::size_t row = row_of(world, body);
    if (model.has_frame(row)) return rigid_sums(model, row).elastic;
    return kernels().elastic_energy(model.all_elements(), model.bodies.blocks[row], model.nodes.position);
}

/// Rate at which the theta method damps the amplitude of a vibration [1/s]. In each step the amplitude is multiplied by
/// sqrt((1 + (1 - theta)^2 z^2) / (1 + theta^2 z^2)). `z`: circular frequency times step.
Real damping_rate(Real z, Real theta, Real step) {
    return std::log((1 + theta * theta * z * z) / (1 + (1 - theta) * (1 - theta) * z * z)) / (2 * step);
}

/// Relative error of the frequency of a vibration by the theta method (`implicit`) or by symplectic Euler, to second
/// order in `z`, the circular frequency times the step.
Real frequency_error(Real z, bool implicit, Real theta) {
    return z * z * (implicit ? 1.0 / 12 + (theta - 0.5) * (theta - 0.5) : 1.0 / 24);
}

/// Time by which given initial velocities are older than the start [s]. Symplectic Euler treats them as velocities in
/// the middle of the previous step.
Real start_shift(const World& world, Real first_step) {
    return world.settings().integrator == Integrator::leapfrog ? 0 : first_step / 2;
}

std::map<BodyHandle, AttachmentHandle> holders_of(const World& world) {
    std::map<BodyHandle, AttachmentHandle> holders;
    for (const AttachmentHandle attachment : world.attachments()) holders.emplace(world.body(attachment), attachment);
    return holders;
}

/// Angular momentum of a rigid body about its centre of mass [kg m^2/s].
Vec3 spin_momentum(const World& world, BodyHandle body) {
    const Model& model = model_of(world);
    return model.rigid_bodies.angular_momentum[static_cast<std::size_t>(model.bodies.rigid[row_of(world, body)].begin)];
}

/// Rate of the error of the rotation of a free rigid body: h^2/24 |w| |dw/dt|, with the step h and the angular velocity
/// w, which changes even without torques [rad/s]. This is the size of the second-order terms of the splitting into
/// rotations about the principal axes (docs/methods/rigid_bodies.md 2).
Real tumbling_error(const World& world, BodyHandle body, Real step) {
    const Model& model = model_of(world);
    const auto r = static_cast<std::size_t>(model.bodies.rigid[row_of(world, body)].begin);
    const RigidBodyTable& table = model.rigid_bodies;
    const Vec3& moments = table.moments[r];
    const Vec3 momentum = table.rotation[r].transpose() * table.angular_momentum[r];
    const Vec3 spin = momentum.cwiseQuotient(moments);
    return step * step / 24 * spin.norm() * momentum.cross(spin).cwiseQuotient(moments).norm();
}

bool has_restitution(const World& world) {
    const auto any = [](std::span<const SurfaceProperties> surfaces) {
        return std::ranges::any_of(surfaces, [](const SurfaceProperties& of) { return of.restitution > 0; });
    };
    const Model& model = model_of(world);
    return any(model.materials.surface) || any(model.material_pairs.surface) || any(model.surface_sets.surface) ||
           any(model.bodies.surface) || any(model.colliders.surface);
}

/// Bodies that touch another body.
std::set<BodyHandle> touching_bodies(const World& world) {
    std::set<BodyHandle> found;
    for (const Contact& contact : world.contacts())
        if (world.alive(contact.first) && world.alive(contact.second) && !contact.impulse.isZero(0))
            found.insert({contact.first, contact.second});
    return found;
}

}  // namespace

StepError::Frame StepError::frame_of(const World& world, BodyHandle body,
                                     const std::optional<AttachmentHandle>& holder) {
    if (!holder)
        return {pose_of_body(model_of(world), row_of(world, body)), world.center_of_mass(body), world.velocity(body)};
    const MotionKey pose = world.pose(*holder);
    return {{pose.position, rotation_matrix(pose.rotation)}, pose.position, world.velocity(*holder)};
}

StepError::Deformation StepError::deformation_of(const World& world, BodyHandle body, const Frame& frame,
                                                 const RigidPose& mesh) {
    const Model& model = model_of(world);
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[row_of(world, body)]);
    const std::span<const Vec3> position = world.positions(body), velocity = world.velocities(body);
    const Mat3 to_frame = frame.pose.rotation.transpose();
    Deformation found;
    for (std::size_t n = 0; n < rest.size(); ++n) {
        found.displacement.push_back(to_frame * (position[n] - frame.pose.position) - mesh.position -
                                     mesh.rotation * rest[n]);
        found.velocity.push_back(to_frame * (velocity[n] - frame.motion.velocity -
                                             frame.motion.angular_velocity.cross(position[n] - frame.center)));
    }
    return found;
}

StepError::Motion StepError::begin(const World& world, BodyHandle body, std::optional<AttachmentHandle> holder) {
    const std::span<const Vec3> position = world.positions(body);
    const Frame frame = frame_of(world, body, holder);
    Motion motion{.start_time = world.time(),
                  .start = {position.begin(), position.end()},
                  .start_velocity = world.velocity(body),
                  .velocity = world.velocity(body).velocity,
                  .holder = holder,
                  .rest_mesh_pose = {Vec3::Zero(), Mat3::Identity()},
                  .dissipated = dissipated_by(world),
                  .rest_displacement = least_motion * world.mean_edge(body)};
    if (holder) {
        const RigidPose& added = model_of(world).body_records[row_of(world, body)].start;
        const Mat3 to_frame = frame.pose.rotation.transpose();
        motion.rest_mesh_pose = {to_frame * (added.position - frame.pose.position), to_frame * added.rotation};
    }
    if (world.dynamics(body) == BodyDynamics::rigid)
        motion.start_spin = spin_momentum(world, body);
    else
        motion.deformation = deformation_of(world, body, frame, motion.rest_mesh_pose);
    return motion;
}

/// Estimates the position error of the rigid motion of a body (docs/methods/error_estimates.md 2) [m]. Symplectic Euler
/// treats given velocities as those of half a step before the start, so the error is half a step times the change of
/// the velocity since the start. In a collision, a position error also turns the direction in which the body continues.
Real StepError::rigid_error(const World& world, BodyHandle body, const Frame& frame, const Interval& interval,
                            Motion& motion) {
    if (motion.holder) return 0;
    const std::span<const Vec3> position = world.positions(body);
    const Real radius = mean_size(world, body, [&](std::size_t n) { return Vec3(position[n] - frame.center); });
    const Twist &now = frame.motion, &start = motion.start_velocity;
    const bool is_rigid = motion.deformation.displacement.empty();
    // The angular velocity of a rigid body changes even without torques. Such changes cause only errors of second order
    // and must not count, so the change of the angular momentum is used.
    const Real turned =
        is_rigid ? (spin_momentum(world, body) - motion.start_spin).norm() / (world.mass(body) * radius * radius)
                 : (now.angular_velocity - start.angular_velocity).norm();
    const Real change = std::hypot((now.velocity - start.velocity).norm(), radius * turned);
    if (motion.acceleration < 0) motion.acceleration = change / interval.seconds;
    // `accelerated` is the change of the velocity that the initial acceleration would have caused until now. It is an
    // upper limit of the change that counts, so that sudden later changes, as in collisions, do not count in full.
    const Real accelerated = motion.acceleration * (world.time() - motion.start_time);
    const Real start_error = std::min(change, accelerated) * start_shift(world, motion.first_step);
    if (is_rigid) motion.tumbled += interval.seconds * radius * tumbling_error(world, body, interval.step);
    const Real error = start_error + motion.rebound_error + motion.tumbled;
    const Vec3 velocity_change = now.velocity - motion.velocity;
    if (interval.collided.contains(body))
        motion.rebound_error_rate += velocity_change.norm() * std::min(Real{1}, std::numbers::sqrt2 * error / radius);
    // Restitution reverses the velocity at the end of a step instead of at the time of impact, on average half a step
    // late. Each rebound adds a position error: this delay times the change of the velocity, without the change by
    // gravity.
    if (interval.rebounds) {
        const Real rebound = (velocity_change - interval.seconds * world.settings().gravity).norm();
        motion.rebound_error += std::min(velocity_change.norm(), rebound) * interval.step / 2;
    }
    motion.velocity = now.velocity;
    motion.rebound_error_rate = std::min(motion.rebound_error_rate, now.velocity.norm());
    motion.rebound_error += interval.seconds * motion.rebound_error_rate;
    return error;
}

Real StepError::deformation_error(const World& world, BodyHandle body, const Frame& frame, const Interval& interval,
                                  Motion& motion) {
    Deformation now = deformation_of(world, body, frame, motion.rest_mesh_pose);
    std::swap(now, motion.deformation);
    const Deformation &before = now, &after = motion.deformation;
    const Real size = size_of(world, body, after.displacement), speed = size_of(world, body, after.velocity);
    motion.largest = std::max(motion.largest, size);
    motion.stiffness += 2 * elastic_energy_of(world, body);
    motion.inertia += world.mass(body) * size * size;
    if (!(motion.inertia > 0)) return 0;
    const Real frequency = std::sqrt(motion.stiffness / motion.inertia);  // circular [1/s]
    const Settings& settings = world.settings();
    const bool implicit = world.dynamics(body) == BodyDynamics::implicit_elastic;
    const Real step = implicit && !motion.holder ? std::max(interval.step, settings.implicit_step) : interval.step;
    motion.phase_time_error += interval.seconds * frequency_error(frequency * step, implicit, settings.theta);
    if (!implicit) {
        return (motion.phase_time_error + start_shift(world, motion.first_step)) * speed;
    }
    // Root mean square displacement of the vibrations that began between the two samples. It is estimated as the change
    // of the displacements minus the integral of the velocities by the trapezoidal rule, that is, the part of the
    // change that the velocities at both samples do not explain.
    const Real begun = mean_size(world, body, [&](std::size_t n) {
        return Vec3(after.displacement[n] - before.displacement[n] -
                    interval.seconds / 2 * (after.velocity[n] + before.velocity[n]));
    });
    const Real decay = interval.seconds * damping_rate(frequency * step, settings.theta, step);
    motion.lost += -std::expm1(-decay) * begun;
    if (frequency > 0) motion.lost += decay * std::numbers::sqrt2 * speed / frequency;
    // The damping of a vibration dissipates its energy. The lost amplitude a is therefore limited by stiffness a^2 / 2
    // <= dissipated energy. Under slow loads, where no vibration is lost, this limit is small.
    const Real stiffness = motion.stiffness * world.mass(body) / motion.inertia;  // [N/m]
    const Real dissipated = dissipated_by(world) - motion.dissipated;
    if (stiffness > 0) motion.lost = std::min(motion.lost, std::sqrt(2 * std::max(Real{0}, dissipated) / stiffness));
    motion.lost = std::min(motion.lost, motion.largest);
    // The position error by a wrong phase is at most twice the amplitude of the vibration. The amplitude is sqrt(2)
    // speed / frequency.
    const Real phase = frequency > 0 ? std::min(motion.phase_time_error, 2 * std::numbers::sqrt2 / frequency)
                                     : motion.phase_time_error;
    return phase * speed + motion.lost;
}

void StepError::go_on(const World& world, BodyHandle body, const Interval& interval, Motion& motion) {
    if (motion.first_step == 0) motion.first_step = interval.step;
    const Frame frame = frame_of(world, body, motion.holder);
    Real error = rigid_error(world, body, frame, interval, motion);
    const bool strained = model_of(world).bodies.unstrained[row_of(world, body)] == 0;
    if (strained && !motion.deformation.displacement.empty())
        error += deformation_error(world, body, frame, interval, motion);
    const std::span<const Vec3> position = world.positions(body);
    motion.error = std::max(motion.error, error);
    motion.moved = std::max(motion.moved,
                            mean_size(world, body, [&](std::size_t n) { return Vec3(position[n] - motion.start[n]); }));
}

void StepError::sample(const World& world) {
    const std::uint64_t steps = WorldAccess::state_of(world).record.counters.steps;
    const std::map<BodyHandle, AttachmentHandle> holders = holders_of(world);
    const auto steps_taken = static_cast<Real>(steps - steps_);
    Interval interval{world.time() - time_, (world.time() - time_) / steps_taken, {}, has_restitution(world)};
    std::set<BodyHandle> touching = touching_bodies(world);
    std::ranges::set_symmetric_difference(touching, touching_,
                                          std::inserter(interval.collided, interval.collided.end()));
    touching_.swap(touching);
    for (const BodyHandle body : world.bodies()) {
        const auto holder = holders.find(body);
        const auto held = holder == holders.end() ? std::nullopt : std::optional(holder->second);
        const auto motion = motions_.find(body);
        // The estimate of a body starts again after a change of its supports or of its kind of motion.
        if (motion == motions_.end() || motion->second.holder != held ||
            motion->second.deformation.displacement.empty() != (world.dynamics(body) == BodyDynamics::rigid))
            motions_.insert_or_assign(body, begin(world, body, held));
        else if (steps_taken > 0 && !world.asleep(body))
            go_on(world, body, interval, motion->second);
    }
    time_ = world.time();
    steps_ = steps;
}

void StepError::add_to(std::vector<ErrorEstimate>& bodies) const {
    for (ErrorEstimate& estimate : bodies) {
        const auto motion = motions_.find(estimate.body);
        if (motion == motions_.end()) continue;
        const Motion& found = motion->second;
        if (!(found.moved > found.rest_displacement)) continue;
        estimate.step = std::min(Real{1}, found.error / found.moved);
        if (!found.deformation.displacement.empty())
            estimate.deformation = std::min(Real{1}, found.largest / found.moved);
    }
}

}  // namespace skerry
