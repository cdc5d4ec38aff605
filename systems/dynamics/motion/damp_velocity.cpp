#include "systems/dynamics/motion/damp_velocity.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "components/check.h"
#include "components/lanes.h"
#include "jobs/parallel_for.h"

namespace skerry {

namespace {

constexpr std::size_t damped_blocks_per_job = 8;

Real damping_of(const DampingInputs& bodies, std::size_t body) {
    const Index material = bodies.body_material[body];
    return material == no_index ? 0 : bodies.material_damping[static_cast<std::size_t>(material)];
}

/// True if damping preserves the rigid motion of a body, because none of its nodes is pinned.
bool keeps_rigid_motion(const DampingInputs& bodies, std::size_t body) {
    return bodies.body_pinned_count[body] == 0;
}

bool is_damped(const DampingInputs& bodies, std::size_t body) {
    const bool has_frame = !bodies.body_rigid.empty() && bodies.body_rigid[body].size() > 0;
    return damping_of(bodies, body) > 0 && bodies.body_node_blocks[body].size() > 0 &&
           (bodies.body_idle.empty() || !bodies.body_idle[body]) && !has_frame &&
           !(bodies.body_unstrained[body] > 0 && keeps_rigid_motion(bodies, body));
}

/// First node of a body. Its position and velocity are the reference for the sums over the body, because sums of world
/// coordinates would lose digits far from the origin.
std::size_t first_node(const DampingInputs& bodies, std::size_t body) {
    return static_cast<std::size_t>(bodies.block_begin[static_cast<std::size_t>(bodies.body_node_blocks[body].begin)]);
}

/// Position of a node at the time to which its velocity belongs. This is `lag` before the time of its position `x`.
template <class T>
T earlier(const T& x, const T& velocity, Real lag) {
    return x - lag * velocity;
}

// Vectors in registers, with their components side by side. Sums over nodes use them.
Real4 load(const Vec3& v) {
    return Real4{v[0], v[1], v[2], 0};
}
Vec3 vec3(const Real4& v) {
    return {v[0], v[1], v[2]};
}
Real4 cross(const Real4& a, const Real4& b) {
    return __builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
           __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}

/// Sums of mass, momentum and moments over one node block, with positions and velocities relative to the first node of
/// the body.
NodeBlockSums sum_block(const DampingInputs& bodies, std::size_t block, std::span<const Vec3> velocity) {
    const std::size_t origin = first_node(bodies, static_cast<std::size_t>(bodies.block_body[block]));
    const Real4 x_origin = load(bodies.position[origin]), v_origin = load(velocity[origin]), one{0, 0, 0, 1};
    Real4 momentum_and_mass{}, first{}, angular{}, second[3]{};
    for (std::size_t n = static_cast<std::size_t>(bodies.block_begin[block]);
         n < static_cast<std::size_t>(bodies.block_end[block]); ++n) {
        if (!(bodies.inverse_mass[n] > 0)) continue;
        const Real m = bodies.mass[n];
        const Real4 x = load(bodies.position[n]) - x_origin, v = load(velocity[n]) - v_origin;
        const Real4 p = m * (v + one), moment = m * earlier(x, v, bodies.lag);
        momentum_and_mass += p;
        first += m * x;
        angular += cross(x, p);
        for (int i = 0; i < 3; ++i) second[i] += moment * x[i];
    }
    NodeBlockSums sums{momentum_and_mass[3], vec3(momentum_and_mass), vec3(first), vec3(angular), Mat3::Zero(), 0};
    for (int i = 0; i < 3; ++i) sums.second_moment.col(i) = vec3(second[i]);
    return sums;
}

/// Adds up the sums over the blocks of a body, and writes the total to the entry of its first block. In the total,
/// momentum is in the world frame; second moments and angular momentum are about the centre of mass.
void add_up_body(const DampingInputs& bodies, std::size_t body, std::span<const Vec3> velocity,
                 std::span<NodeBlockSums> sums) {
    const Range blocks = bodies.body_node_blocks[body];
    NodeBlockSums& total = sums[static_cast<std::size_t>(blocks.begin)];
    for (std::size_t b = static_cast<std::size_t>(blocks.begin) + 1; b < static_cast<std::size_t>(blocks.end); ++b) {
        total.mass += sums[b].mass;
        total.momentum += sums[b].momentum;
        total.first_moment += sums[b].first_moment;
        total.angular_momentum += sums[b].angular_momentum;
        total.second_moment += sums[b].second_moment;
    }
    if (!(total.mass > 0)) return;
    total.angular_momentum -= total.first_moment.cross(total.momentum) / total.mass;
    total.second_moment -=
        earlier(total.first_moment, total.momentum, bodies.lag) * total.first_moment.transpose() / total.mass;
    total.momentum += total.mass * velocity[first_node(bodies, body)];
}

/// Angular velocity omega of a body's rigid motion (docs/methods/time_stepping.md 3.1). With the node masses m, the
/// present positions x and the positions y at the time of the velocities, S is the sum of m y x^T. omega solves
/// (tr(S) I - S) omega = L with the angular momentum L and the unit matrix I. If all nodes are on one line, omega has
/// no component along this line.
Vec3 angular_velocity_of(const NodeBlockSums& total) {
    const Mat3 inertia = total.second_moment.trace() * Mat3::Identity() - total.second_moment;
    const Real mean = inertia.trace() / 3;
    // The inverse is used if the ratio of the determinant to the cube of the mean moment of inertia exceeds this limit.
    // It then loses at most about six of 16 digits; for most bodies it loses none.
    constexpr Real well_shaped = 1e-6;
    if (inertia.determinant() > well_shaped * mean * mean * mean) return inertia.inverse() * total.angular_momentum;
    const Eigen::JacobiSVD<Mat3> turned(inertia, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Real least = 1e-12 * turned.singularValues()[0];  // smaller moments of inertia are rounding errors
    Vec3 omega = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
        if (turned.singularValues()[i] > least)
            omega += turned.matrixV().col(i) *
                     (turned.matrixU().col(i).dot(total.angular_momentum) / turned.singularValues()[i]);
    return omega;
}

/// Rigid motion towards which node velocities are damped. `linear`: velocity of the point `origin` + `centre`.
/// `angular`: angular velocity. `fraction`: fraction of the difference from this motion that damping removes.
struct DampedTowards {
    Vec3 linear, angular, origin, centre;
    Real lag, fraction;
};

/// Damps velocity_next of consecutive nodes towards a rigid motion, several nodes at a time. No node may be held.
/// work[n]: kinetic energy removed from node n [J].
void damp_free(const DampedTowards& rigid, std::size_t count, const Vec3* position, const Vec3* velocity,
               const Real* mass, Vec3* velocity_next, Real* work) {
    const Real *const x = position->data(), *const v = velocity->data();
    Real* const next = velocity_next->data();
    const Real lx = rigid.linear[0], ly = rigid.linear[1], lz = rigid.linear[2], ax = rigid.angular[0],
               ay = rigid.angular[1], az = rigid.angular[2], ox = rigid.origin[0], oy = rigid.origin[1],
               oz = rigid.origin[2], cx = rigid.centre[0], cy = rigid.centre[1], cz = rigid.centre[2], lag = rigid.lag,
               fraction = rigid.fraction, half = rigid.fraction / 2;
#pragma omp simd
    for (std::size_t n = 0; n < count; ++n) {
        const Real vx = v[3 * n] - lx, vy = v[3 * n + 1] - ly, vz = v[3 * n + 2] - lz;
        const Real rx = earlier(x[3 * n] - ox - cx, vx, lag), ry = earlier(x[3 * n + 1] - oy - cy, vy, lag),
                   rz = earlier(x[3 * n + 2] - oz - cz, vz, lag);
        const Real ex = vx - (ay * rz - az * ry), ey = vy - (az * rx - ax * rz), ez = vz - (ax * ry - ay * rx);
        next[3 * n] -= fraction * ex;
        next[3 * n + 1] -= fraction * ey;
        next[3 * n + 2] -= fraction * ez;
        // The removed energy is the difference of the kinetic energies m v^2/2 without and with damping. It cannot be
        // computed from the deformation velocity alone: that velocity is not quite orthogonal to the rigid motion if
        // positions and velocities belong to different times.
        work[n] = mass[n] * fraction * (ex * (vx - half * ex) + (ey * (vy - half * ey) + ez * (vz - half * ez)));
    }
}

/// Damps velocity_next of a node block by `fraction` towards the rigid motion given by the sums of the body, or towards
/// zero velocity if the body has pinned nodes. Returns the removed kinetic energy [J].
Real damp_block(const DampingInputs& bodies, std::size_t block, Real fraction, const NodeBlockSums& total,
                std::span<const Vec3> velocity, std::span<Vec3> velocity_next) {
    const std::size_t body = static_cast<std::size_t>(bodies.block_body[block]);
    const bool keeps = keeps_rigid_motion(bodies, body);
    if (keeps && !(total.mass > 0)) return 0;
    const Vec3 none = Vec3::Zero();
    const DampedTowards rigid{keeps ? Vec3(total.momentum / total.mass) : none,
                              keeps ? angular_velocity_of(total) : none,
                              bodies.position[first_node(bodies, body)],
                              keeps ? Vec3(total.first_moment / total.mass) : none,
                              bodies.lag,
                              fraction};
    const auto begin = static_cast<std::size_t>(bodies.block_begin[block]),
               end = static_cast<std::size_t>(bodies.block_end[block]);
    std::array<Real, nodes_per_block> work;
    SKERRY_CHECK(end - begin <= work.size());
    Real removed = 0;  // removed kinetic energy, summed in node order [J]
    for (std::size_t first = begin, last = begin; first < end; first = last + 1) {
        for (last = first; last < end && bodies.inverse_mass[last] > 0;) ++last;
        if (last == first) continue;
        damp_free(rigid, last - first, &bodies.position[first], &velocity[first], &bodies.mass[first],
                  &velocity_next[first], work.data());
        for (std::size_t n = 0; n < last - first; ++n) removed += work[n];
    }
    return removed;
}

}  // namespace

bool damp_velocity(Executor& executor, const DampingInputs& bodies, std::span<const Vec3> velocity, Real kick,
                   std::span<NodeBlockSums> sums, std::span<Vec3> velocity_next, Real& dissipated) {
    const std::size_t body_count = bodies.body_node_blocks.size(), block_count = bodies.block_begin.size();
    SKERRY_CHECK(sums.size() == block_count);
    dissipated = 0;
    bool any = false;
    for (std::size_t body = 0; body < body_count && !any; ++body) any = is_damped(bodies, body);
    if (!any) return false;

    parallel_for(executor, block_count, damped_blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const std::size_t body = static_cast<std::size_t>(bodies.block_body[b]);
            if (is_damped(bodies, body) && keeps_rigid_motion(bodies, body)) sums[b] = sum_block(bodies, b, velocity);
        }
    });
    for (std::size_t body = 0; body < body_count; ++body)
        if (is_damped(bodies, body) && keeps_rigid_motion(bodies, body)) add_up_body(bodies, body, velocity, sums);
    parallel_for(executor, block_count, damped_blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            sums[b].dissipated = 0;
            const std::size_t body = static_cast<std::size_t>(bodies.block_body[b]);
            if (!is_damped(bodies, body)) continue;
            const NodeBlockSums& total = sums[static_cast<std::size_t>(bodies.body_node_blocks[body].begin)];
            const Real removed =
                damp_block(bodies, b, -std::expm1(-damping_of(bodies, body) * kick), total, velocity, velocity_next);
            if (!bodies.ghosts.contain(static_cast<Index>(body))) sums[b].dissipated = removed;
        }
    });
    for (const NodeBlockSums& block : sums) dissipated += block.dissipated;
    return true;
}

}  // namespace skerry
