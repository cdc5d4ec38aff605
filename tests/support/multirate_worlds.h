// A box with slivers, and what moves it, for tests of multirate.
#pragma once

#include <vector>

#include "jobs/executor.h"
#include "tests/support/sliver_box.h"
#include "tests/support/worlds.h"

namespace skerry::test {

inline constexpr Real box_size = 0.1, flatness = 0.04;
inline constexpr int box_cells = 8;

inline const Mesh& sliver_mesh() {
    static const Mesh mesh = sliver_box(box_size, box_cells, 0.02, flatness);
    return mesh;
}

/// A smooth motion that strains the whole box by some per cent and turns it.
inline void stir(World& world, BodyHandle body, const Mesh& mesh, Real speed = 0.3) {
    std::vector<Vec3> velocity;
    for (const Vec3& x : mesh.nodes)
        velocity.push_back(speed * Vec3(std::sin(30 * x.y()), 20 * x.z(), std::cos(25 * x.x())) +
                           Vec3(1, 2, 3).cross(x));
    world.set_velocities(body, velocity);
}

/// The ball on a soft box with slivers: without these its steps could be as much longer as those of the block.
inline World ball_on_slivers(bool multirate, Integrator integrator = Integrator::symplectic_euler,
                             Backend backend = Backend::automatic, int threads = 0) {
    Settings settings;
    settings.integrator = integrator;
    settings.multirate = multirate;
    settings.backend = backend;
    settings.threads = threads;
    World world(settings);
    const auto rubber = [&](Real modulus) {
        return world.add_material(
            test::lossless({.young_modulus = modulus, .poisson_ratio = 0.3, .friction = 0.4, .damping = 2}));
    };
    world.add_collider(Plane{});
    world.add_body(
        sliver_mesh(),
        {.material = rubber(2e4), .position = {0, 0, 0.052}, .element = ElementKind::linear, .name = "soft"});
    world.add_body(mesh::ball(0.04, 4), {.material = rubber(1e7),
                                         .position = {0.01, 0, 0.15},
                                         .velocity = {0.2, 0, -0.5},
                                         .element = ElementKind::linear,
                                         .name = "stiff"});
    return world;
}

/// J.
inline Real total_energy(const World& world) {
    const Energy energy = world.energy();
    return energy.kinetic + energy.elastic;
}

}  // namespace skerry::test
