// A rubber ball falls onto the floor: the whole interface in ten lines.
#include <skerry/world.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>

int main() {
    skerry::World world;  // settings have defaults that work
    auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.4, .density = 1000, .friction = 0.5});
    auto ball = world.add_body(skerry::mesh::ball(0.1, 8), {.material = rubber, .position = {0, 0, 1}});
    world.add_collider(skerry::Plane{.normal = {0, 0, 1}});

    skerry::Real highest = 0, lowest = 1;  // of any node [m]
    while (world.time() < 2.0) {
        const skerry::StepReport report = world.advance(1.0 / 60.0);  // takes as many stable steps as needed
        if (!report.ok()) throw std::runtime_error(report.message());

        const std::span<const skerry::Vec3> where = world.positions(ball);  // no copy
        for (const skerry::Vec3& node : where) {
            lowest = std::min(lowest, node.z());
            highest = std::max(highest, node.z());
        }
    }

    const skerry::WorldReport report = world.report();
    std::cout << "After " << world.time() << " s and " << report.steps << " steps the ball's centre is "
              << world.center_of_mass(ball).z() << " m above the floor; it touched the floor with up to "
              << report.max_contacts << " nodes.\n";

    // The ball reached the floor, did not sink into it, and did not jump higher than it was dropped from.
    const bool as_expected = lowest < 0.01 && lowest > -0.001 && highest < 1.1 && report.max_contacts > 0;
    return as_expected ? 0 : 1;
}
