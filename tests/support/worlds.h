// One-line worlds for whole-step tests.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "skerry/world.h"

namespace skerry::test {

inline constexpr Real standard_gravity = 9.81;  // [m/s^2]

/// Gravity on a plane tilted by `degrees` about y, seen from the plane: downhill is +x.
inline Vec3 tilted_gravity(Real degrees) {
    const Real a = degrees * std::numbers::pi / 180;
    return standard_gravity * Vec3(std::sin(a), 0, -std::cos(a));
}

/// The material without losses, for tests of energies, frequencies and orders in closed form.
inline MaterialSettings lossless(MaterialSettings material) {
    material.loss_factor = material.bulk_viscosity = 0;
    return material;
}

/// Settings that solve contacts until only the error of the step is left. Sleep is off: a sleeping body may
/// differ from its static state by a thousandth.
inline Settings accurate(const Vec3& gravity = {0, 0, -standard_gravity}, Real tolerance = 1e-8) {
    Settings settings;
    settings.gravity = gravity;
    settings.tolerance = tolerance;
    settings.max_iterations = 20000;
    settings.sleep = false;
    return settings;
}

/// Masses of the nodes of one body [kg]. A world reports masses only as sums, so a test computes them from the
/// tetrahedra around each node.
inline std::vector<Real> node_masses(const World& world, BodyHandle body, const Mesh& mesh, Real density) {
    std::vector<Real> mass(world.positions(body).size(), 0);
    for (const auto& t : mesh.tetrahedra) {
        const Vec3 a = mesh.nodes[static_cast<std::size_t>(t[0])];
        Mat3 edges;
        for (int k = 0; k < 3; ++k)
            edges.col(k) = mesh.nodes[static_cast<std::size_t>(t[static_cast<std::size_t>(k + 1)])] - a;
        for (Index corner : t) mass[static_cast<std::size_t>(corner)] += density * edges.determinant() / 24;
    }
    return mass;
}

inline Vec3 mean_velocity(const World& world, BodyHandle body, std::span<const Real> mass) {
    Vec3 momentum = Vec3::Zero();
    Real sum = 0;
    const auto velocity = world.velocities(body);
    for (std::size_t n = 0; n < velocity.size(); ++n) {
        momentum += mass[n] * velocity[n];
        sum += mass[n];
    }
    return momentum / sum;
}

/// Faces of the surface of a body whose nodes are all in a region. `inside`: true for positions in the region.
std::vector<std::array<Index, 3>> faces_where(const World& world, BodyHandle body, auto&& inside) {
    std::vector<std::array<Index, 3>> list;
    const auto nodes = world.positions(body);
    for (const std::array<Index, 3>& face : world.surface(body))
        if (std::ranges::all_of(face, [&](Index n) { return inside(nodes[static_cast<std::size_t>(n)]); }))
            list.push_back(face);
    return list;
}

/// Moves each node of a body to the product of F and its position in the mesh.
inline void deform(World& world, BodyHandle body, const Mesh& mesh, const Mat3& F) {
    std::vector<Vec3> shape;
    for (const Vec3& x : mesh.nodes) shape.emplace_back(F * x);
    world.set_positions(body, shape);
}

/// Kinetic and elastic energy of a world [J].
inline Real energy_of(const World& world) {
    const WorldReport report = world.report();
    return report.energy.kinetic + report.energy.elastic;
}

/// A block lying on the plane z = 0, just at the contact distance, in a world with tilted gravity. The contact distance
/// is a fiftieth of the block's height.
struct BlockOnPlane {
    World world;
    BodyHandle block;
    Mesh mesh;
    std::vector<Real> mass;

    BlockOnPlane(Settings settings, const MaterialSettings& material, const Vec3& size = {0.2, 0.2, 0.1},
                 const std::array<int, 3>& cells = {4, 4, 2})
        : world(settings), mesh(mesh::box(size, cells)) {
        const auto rubber = world.add_material(material);
        world.add_collider(Plane{});
        const Real shell = 0.02 * size.z();
        block = world.add_body(mesh, {.material = rubber,
                                      .position = {0, 0, (size.z() + shell) / 2},
                                      .contact_distance = shell,
                                      .name = "block"});
        mass = node_masses(world, block, mesh, material.density);
    }

    Vec3 velocity() const { return mean_velocity(world, block, mass); }
    /// Lets the weight settle, then turns gravity to its target direction with a smooth start and end. A sudden change
    /// of the tilt or of its rate would make the block sway and slip.
    void settle(Real seconds, Real ramp = 0.5) {
        const Vec3 tilted = world.settings().gravity;
        world.set_gravity({0, 0, tilted.z()});
        world.advance(seconds);
        const int turns = 200;
        for (int i = 1; i <= turns; ++i) {
            const Real s = static_cast<Real>(i) / turns;
            world.set_gravity({tilted.x() * s * s * s * (10 - 15 * s + 6 * s * s), 0, tilted.z()});
            world.advance(ramp / turns);
        }
    }
};

}  // namespace skerry::test
