// A bar that is held as a ring whose ends lie in each other.
#pragma once

#include <cmath>
#include <numeric>
#include <vector>

#include "skerry/world.h"

namespace skerry::test {

struct CrossingRing {
    World world;
    Mesh bar = mesh::box({0.8, 0.06, 0.03}, {24, 2, 1});
    BodyHandle body;
    AttachmentHandle held;

    static Settings settings() {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.step_size = 1e-3;
        settings.sleep = false;
        return settings;
    }
    CrossingRing() : world(settings()) {
        const auto rubber = world.add_material({.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 1000});
        body = world.add_body(bar, {.material = rubber, .name = "ring"});
        world.add_body(mesh::ball(0.1, 4), {.material = rubber, .position = {0, 0, 2}, .name = "ball"});
    }
    void close() {
        constexpr Real radius = 0.8 / 6.8;
        std::vector<Vec3> ring;
        for (const Vec3& x : bar.nodes) {
            const Real angle = x.x() / radius;
            ring.emplace_back((radius - x.z()) * std::sin(angle), x.y(), radius - (radius - x.z()) * std::cos(angle));
        }
        world.set_positions(body, ring);
        std::vector<Index> all(bar.nodes.size());
        std::iota(all.begin(), all.end(), 0);
        held = world.attach(body, all);
    }
    void open() {
        world.remove(held);
        world.set_positions(body, bar.nodes);
    }
};

}  // namespace skerry::test
