// Worlds of equal capsules, and floors for them.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "engine/world/tuning.h"
#include "engine/world/world_state.h"
#include "systems/geometry/closest_points.h"
#include "tests/support/worlds.h"

namespace skerry::test::capsules {

inline constexpr Real radius = 0.1, length = 0.4, kept = 0.001, density = 1000, g = standard_gravity,
                      pi = std::numbers::pi;
inline const Real ball = 4 * pi / 3 * density * radius * radius * radius,
                  shaft = pi * density * radius * radius * length, mass = ball + shaft,
                  axial = ball * 0.4 * radius * radius + shaft * radius * radius / 2,
                  // one half ball by itself: 83/320 m R^2 about its centre of mass, 3/8 R beyond the end of the axis
    across = ball * (83.0 / 320 * radius * radius + std::pow(length / 2 + 3.0 / 8 * radius, 2)) +
             shaft * (radius * radius / 4 + length * length / 12);
// rotations that turn the axis from z to x and to y
inline const Vec3 along_x(0, pi / 2, 0), along_y(-pi / 2, 0, 0);

struct Capsules {
    World world;
    MaterialHandle material;

    explicit Capsules(const Settings& settings, Real mu = 0.5, Real restitution = 0, const Tuning& tuning = {})
        : world(tuned_world(settings, tuning)),
          material(world.add_material(
              {.young_modulus = 1e6, .density = density, .friction = mu, .restitution = restitution})) {}

    BodySettings placed(const Vec3& position, const Vec3& rotation, const Vec3& velocity = Vec3::Zero(),
                        const Vec3& spin = Vec3::Zero(), const std::string& name = "") const {
        return {.material = material,
                .position = position,
                .rotation = rotation,
                .velocity = velocity,
                .angular_velocity = spin,
                .contact_distance = kept,
                .dynamics = BodyDynamics::rigid,
                .name = name};
    }
    BodyHandle add(const Vec3& position, const Vec3& rotation, const Vec3& velocity = Vec3::Zero(),
                   const Vec3& spin = Vec3::Zero(), const std::string& name = "") {
        return world.add_body(Capsule{radius, length}, placed(position, rotation, velocity, spin, name));
    }
    std::size_t row(BodyHandle body) const {
        const Model& model = WorldAccess::state_of(world).model;
        return static_cast<std::size_t>(model.bodies.rigid[model.row(body, "test")].begin);
    }
    Vec3 velocity(BodyHandle body) const {
        const RigidBodyTable& table = WorldAccess::state_of(world).model.rigid_bodies;
        return table.momentum[row(body)] / table.mass[row(body)];
    }
    Vec3 spin(BodyHandle body) const {
        const RigidBodyTable& table = WorldAccess::state_of(world).model.rigid_bodies;
        const std::size_t r = row(body);
        return table.rotation[r] *
               (table.rotation[r].transpose() * table.angular_momentum[r]).cwiseQuotient(table.moments[r]);
    }
    Vec3 middle(BodyHandle body) const { return (end(body, 0) + end(body, 1)) / 2; }
    Vec3 end(BodyHandle body, std::size_t k) const { return world.positions(body)[k]; }
    /// Distance between the axes of two capsules [m].
    Real apart(BodyHandle a, BodyHandle b) const {
        return std::sqrt(closest_points_of_segments(end(a, 0), end(a, 1), end(b, 0), end(b, 1)).distance_squared);
    }
};

inline Settings steps_of(Real h, const Vec3& gravity = {0, 0, -g}) {
    Settings settings = accurate(gravity, 1e-10);
    settings.step_size = h;
    return settings;
}

/// Kinds of floor with the upper side at z = 0. add_floor() returns the distance that a capsule keeps to it [m].
enum Floor { plane, box, mesh_collider, rigid_slab };

inline Real add_floor(Capsules& c, Floor floor) {
    const Mesh slab = mesh::box({4, 1, 0.2}, {16, 4, 1});
    if (floor == plane) c.world.add_collider(Plane{});
    if (floor == box) c.world.add_collider(Box{{4, 1, 0.2}}, {.position = {0, 0, -0.1}});
    if (floor == mesh_collider)
        c.world.add_collider(mesh::boundary(slab), {.position = {0, 0, -0.1}, .contact_distance = kept});
    if (floor == rigid_slab) {
        const BodyHandle held = c.world.add_body(slab, {.material = c.material,
                                                        .position = {0, 0, -0.1},
                                                        .contact_distance = kept,
                                                        .dynamics = BodyDynamics::rigid});
        std::vector<Index> all(slab.nodes.size());
        std::iota(all.begin(), all.end(), 0);
        c.world.attach(held, all);
    }
    return floor == plane || floor == box ? kept / 2 : kept;
}

}  // namespace skerry::test::capsules
