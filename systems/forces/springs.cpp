#include "systems/forces/springs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/geometry/rotation.h"

namespace skerry {

Real SpringLaw::tension(Real extension) const {
    return acts(extension) ? std::clamp(stiffness * extension, -strength, strength) : Real(0);
}

Real SpringLaw::energy(Real extension) const {
    if (!acts(extension)) return 0;
    const Real size = std::abs(extension);
    return stiffness * size <= strength ? stiffness * size * size / 2 : strength * (size - strength / stiffness / 2);
}

Real SpringLaw::with_damper(Real extension, Real elastic, Real damper) const {
    if (!acts(extension)) return 0;
    const Real least = side == SpringSide::tension ? 0 : -strength,
               most = side == SpringSide::compression ? 0 : strength;
    return std::clamp(elastic + damper, least, most);
}

bool SpringInputs::is_driven(std::size_t s, Real t, Real h) const {
    return changes(rows_of(key, rest_length[s]), t, h) || first.is_led(s) || second.is_led(s);
}

namespace {

/// Length and direction of a spring. The direction is zero for a length of zero.
struct Stretch {
    Real length;  // [m]
    Vec3 along;   // unit vector from the second anchor to the first

    Stretch(const SpringInputs& springs, std::size_t s) {
        const Vec3 apart = springs.first.at(s) - springs.second.at(s);
        length = apart.norm();
        along = length > 0 ? Vec3(apart / length) : Vec3(Vec3::Zero());
    }
};

/// Inverse mass of an anchor along the direction `along` [1/kg]. If several dampers act on a node or body, each gets an
/// equal share of its mass. With these shares, the dampers together are stable at any step length.
Real divided_inverse_mass(const SpringMasses& masses, const AnchorMass& own, const Mat3& response, Index body,
                          const Vec3& at, const Vec3& along) {
    if (own.dampers == 0) return own.divided;
    const auto r = static_cast<std::size_t>(masses.body_rigid[static_cast<std::size_t>(body)].begin);
    Real inverse = along.dot(response * along);
    if (masses.holder[r] == no_index) {
        const Vec3 turning = masses.rotation[r].transpose() * (at - masses.center[r]).cross(along);
        inverse += 1 / masses.mass[r] + turning.cwiseQuotient(masses.moments[r]).dot(turning);
    }
    return own.dampers * inverse;
}

SpringForce force_of(const SpringInputs& springs, const SpringMasses& masses, std::size_t s, Real t, Real h,
                     Real kick) {
    const Stretch stretch(springs, s);
    const SpringLaw law = springs.law(s);
    const Real rest = springs.rest(s, t), extension = stretch.length - rest;
    SpringForce found;
    found.rest_rate = (springs.rest(s, t + h) - rest) / h;
    const Real elastic = law.tension(extension);
    Real damper = 0;
    if (law.damping > 0 && stretch.length > 0) {
        const Real rate = stretch.along.dot(springs.first.velocity(s) - springs.second.velocity(s));
        const Real inverse_mass = divided_inverse_mass(masses, masses.first[s], masses.first_response[s],
                                                       springs.first.body[s], springs.first.at(s), stretch.along) +
                                  divided_inverse_mass(masses, masses.second[s], masses.second_response[s],
                                                       springs.second.body[s], springs.second.at(s), stretch.along);
        // Mean damper force over the time `kick` for which forces act, if no other force acts: `rate`, the rate of
        // change of the length, then decays exponentially, by the factor exp(-decay) in total.
        const Real decay = kick * law.damping * inverse_mass;
        damper = law.damping * rate * (decay > 0 ? -std::expm1(-decay) / decay : Real(1));
    }
    found.elastic = elastic;
    found.tension = law.with_damper(extension, elastic, damper);
    found.force = -found.tension * stretch.along;
    found.damping = -(found.tension - elastic) * stretch.along;
    return found;
}

/// Velocities of an anchor in a step [m/s].
struct AnchorVelocities {
    Vec3 next;    // weighted sum of its nodes' new velocities, or mean velocity of its collider in this step
    Vec3 during;  // displacement while the forces act, divided by h (measure_work)
};

AnchorVelocities velocities_in_step(const AnchorInputs& anchors, std::size_t s, const SpringWorkInputs& step, Real h,
                                    Real lag) {
    if (const Index collider = anchors.collider[s]; collider != no_index) {
        const RigidMotion& pose = anchors.motion[static_cast<std::size_t>(collider)];
        const Vec3 arm = pose.rotation * anchors.point[s].point;
        const Vec3 mean = pose.velocity + (rotation_matrix(h * pose.angular_velocity) * arm - arm) / h;
        return {mean, mean};
    }
    AnchorVelocities sum{Vec3::Zero(), Vec3::Zero()};
    anchors.for_each_node(s, [&](std::size_t node, Real weight) {
        const Vec3& next = step.velocity_next[node];
        sum.next += weight * next;
        sum.during +=
            weight * (lag == 0 && step.free.contain(node) ? Vec3((anchors.node_velocity[node] + next) / 2) : next);
    });
    return sum;
}

}  // namespace

bool add_spring_forces(Executor& executor, const SpringInputs& springs, const SpringMasses& masses, Real t, Real h,
                       Real kick, std::span<SpringForce> next, std::span<Vec3> applied_force) {
    if (springs.size() == 0) return false;
    constexpr std::size_t springs_per_block = 64;
    parallel_for(executor, springs.size(), springs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) next[s] = force_of(springs, masses, s, t, h, kick);
    });
    for (std::size_t s = 0; s < springs.size(); ++s) {
        springs.first.add_force(s, next[s].force, applied_force);
        springs.second.add_force(s, -next[s].force, applied_force);
    }
    return true;
}

bool mark_driven_bodies(const SpringInputs& springs, Real t, Real h, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t s = 0; s < springs.size(); ++s) {
        if (!springs.is_driven(s, t, h)) continue;
        any = true;
        for (const Index body : {springs.first.body[s], springs.second.body[s]})
            if (body != no_index) marked[static_cast<std::size_t>(body)] = 1;
    }
    return any;
}

SpringWork measure_springs(const SpringInputs& springs, const SpringWorkInputs& step, Real h, Real kick, Real lag) {
    SpringWork sum;
    for (std::size_t s = 0; s < springs.size(); ++s) {
        if (springs.rests(s) || springs.is_ghost(s)) continue;
        const SpringForce& now = step.next[s];
        const Vec3 before = springs.first.velocity(s) - springs.second.velocity(s);
        const AnchorVelocities first = velocities_in_step(springs.first, s, step, h, lag),
                               second = velocities_in_step(springs.second, s, step, h, lag);
        sum.work += h * (now.force.dot(first.during - second.during) + now.elastic * now.rest_rate);
        sum.work += lag * ((now.force - step.force_before[s]).dot(before) +
                           (now.elastic - step.elastic_before[s]) * step.rest_rate_before[s]);
        sum.dissipated -= kick / 2 * now.damping.dot(before + first.next - second.next);
    }
    return sum;
}

Real spring_energy(const SpringInputs& springs, const SpringWorkInputs& last, Real t, Real lag) {
    Real sum = 0;
    for (std::size_t s = 0; s < springs.size(); ++s) {
        if (springs.is_ghost(s)) continue;
        const Stretch stretch(springs, s);
        const Real extension = stretch.length - springs.rest(s, t);
        const SpringLaw law = springs.law(s);
        sum += law.energy(extension);
        if (lag == 0) continue;
        const Real tension = law.tension(extension);
        const Vec3 apart = springs.first.velocity(s) - springs.second.velocity(s);
        sum += lag * ((-tension * stretch.along - last.force_before[s]).dot(apart) +
                      (tension - last.elastic_before[s]) * last.rest_rate_before[s]);
    }
    return sum;
}

bool keep_spring_forces(std::span<const SpringForce> next, const SpringMemory& out) {
    for (std::size_t s = 0; s < next.size(); ++s) {
        out.force[s] = next[s].force;
        out.tension[s] = next[s].tension;
        out.elastic[s] = next[s].elastic;
        out.rest_rate[s] = next[s].rest_rate;
    }
    return !next.empty();
}

}  // namespace skerry
