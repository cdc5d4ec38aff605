// Eight copies of a world, each with another coefficient of friction: two fingers press on a ball and move up. The
// rollout runs the copies at the same time. The ball follows if friction carries its weight.
#include <skerry/rollout.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace skerry;

int main() {
    World world;
    const auto rubber = world.add_material({.young_modulus = 5e4, .density = 500, .damping = 20});
    const auto ball = world.add_body(mesh::ball(0.05, 6), {.material = rubber, .position = {0, 0, 0.052}});
    world.add_collider(Plane{});
    std::array<ColliderHandle, 2> finger;
    for (int i = 0; i < 2; ++i)
        finger[i] = world.add_collider(Box{{0.02, 0.06, 0.06}}, {.position = {i ? 0.07 : -0.07, 0, 0.05}});

    // Poses of the fingers, the same in all worlds: they close for 0.5 s, then rise by 5 cm in 0.5 s.
    const std::size_t worlds = 8, intervals = 100;
    const Real dt = 0.01;  // [s]
    std::array<std::vector<Real>, 2> poses;
    for (std::size_t i = 1; i <= intervals; ++i) {
        const Real closed = std::min(1.0, i * dt / 0.5), raised = std::max(0.0, i * dt / 0.5 - 1);
        const Real x = 0.07 - 0.014 * closed, z = 0.05 + 0.05 * raised;  // [m]
        poses[0].insert(poses[0].end(), {-x, 0, z, 0, 0, 0});
        poses[1].insert(poses[1].end(), {x, 0, z, 0, 0, 0});
    }
    const auto friction = [](std::size_t number) { return 0.1 * (number + 1); };
    const RolloutResult result =
        rollout(world, worlds,
                {.intervals = intervals,
                 .dt = dt,
                 .controls = {{PoseControl{finger[0]}, poses[0]}, {PoseControl{finger[1]}, poses[1]}},
                 .record = {{"ball", BodyProbe{ball}}, {"grip", BodyForceProbe{ball, finger[1]}}},
                 .prepare = [&](World& copy, std::size_t number) {
                     MaterialSettings material = copy.material(rubber);
                     material.friction = friction(number);
                     copy.set_material(rubber, material);
                 }});

    bool as_expected = true;
    for (std::size_t w = 0; w < worlds; ++w) {
        const Real height = result.series[0].values[((w + 1) * intervals - 1) * 9 + 2];  // "position_z" of 9 columns
        const Real grip = result.series[1].values[(w * intervals + 49) * 15 + 10];  // "pressing_force" of 15 columns
        const Real carried = 2 * friction(w) * grip, weight = 9.81 * world.mass(ball);  // [N]
        std::printf("friction %.1f: the fingers can carry %.2f N of %.2f N; the ball is at z = %.1f mm %s\n",
                    friction(w), carried, weight, 1000 * height, result.status[w].message().c_str());
        if (std::abs(carried / weight - 1) > 0.1) as_expected &= (height > 0.09) == (carried > weight);
    }
    return as_expected ? 0 : 1;
}
