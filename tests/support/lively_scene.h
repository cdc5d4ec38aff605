// Worlds with much state that is carried from step to step.
#pragma once

#include "engine/world/tuning.h"
#include "jobs/executor.h"
#include "skerry/world.h"
#include "tests/support/sliver_box.h"

namespace skerry::test {

/// A world with every kind of carried state: stiff and soft elements, also in one body, bodies at rest and bodies that
/// fall onto them, friction, damping, loads, a mesh collider and a capsule that move by scripts, and a held body.
inline World lively_scene(Settings settings, int threads = 1) {
    settings.backend = available_backends().front();
    settings.threads = threads;
    settings.sleep_time = 0.02;
    World world = tuned_world(settings, {.sleep_speed = 0.2});
    const auto soft = world.add_material(
        {.young_modulus = 2e4, .friction = 0.5, .damping = 30, .loss_factor = 0.2, .bulk_viscosity = 0.06});
    const auto stiff = world.add_material({.young_modulus = 4e5,
                                           .friction = 0.3,
                                           .damping = 2,
                                           .loss_factor = 0.05,
                                           .model = MaterialModel::corotational});
    world.add_collider(Plane{});
    Mesh paddle = mesh::box({0.3, 0.05, 0.02}, {3, 1, 1});
    world.add_collider(Capsule{0.02, 0.2}, {.position = {-0.25, 0, 0.05},
                                            .motion = {.keys = {{0, {-0.25, 0, 0.05}, {0, 0, 0}},
                                                                {0.5, {0.05, 0, 0.08}, {0, 0.5, 0}},
                                                                {2, {0.1, 0, 0.08}, {0, 1.5, 0}}}}});
    SurfaceMesh lid;
    lid.nodes = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    lid.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    world.add_collider(lid, {.position = {0.3, 0, 0.01}, .motion = {.velocity = {-0.05, 0, 0}}});
    const Mesh ball = mesh::ball(0.05, 5);
    for (int i = 0; i < 6; ++i)
        world.add_body(ball, {.material = i % 3 == 0 ? stiff : soft,
                              .position = {0.104 * (i % 3) - 0.1, 0.01 * i, 0.052 + 0.2 * (i / 3)},
                              .rotation = {0.3 * i, 0.2, 0.1 * i},
                              .velocity = {0, 0, i < 3 ? 0.0 : -0.5}});
    for (std::size_t e = 0; e < paddle.tetrahedra.size(); ++e) paddle.label.push_back(e % 5 == 0 ? 1 : 0);
    const auto held = world.add_body(paddle, {.material = soft, .materials = {{1, stiff}}, .position = {0, 0.3, 0.3}});
    world.attach(held, std::vector<Index>{0, 1, 2, 3}, {.velocity = {0, 0, 0.01}}, {0, 0.3, 0.3});
    world.set_loads(held, std::vector<Vec3>(world.positions(held).size(), Vec3(0, 1e-3, 0)));
    return world;
}

/// Boxes with slivers, thrown onto a plane. Some of their elements become implicit and stiffen.
inline World thrown_slivers(Settings settings = {}) {
    World world(settings);
    world.add_collider(Plane{});
    const auto soft = world.add_material({.young_modulus = 2e4, .friction = 0.5});
    for (int i = 0; i < 3; ++i)
        world.add_body(sliver_box(0.1, 6, 0.01, 0.005, 1 + static_cast<std::uint64_t>(i)),
                       {.material = soft, .position = {0.02 * i, 0, 0.06 + 0.11 * i}, .velocity = {0, 0, -3}});
    return world;
}

}  // namespace skerry::test
