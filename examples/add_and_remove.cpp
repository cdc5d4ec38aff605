// Bodies are added and removed while the world runs. A handle names its body as long as the body lives, and is known to
// be stale afterwards.
#include <skerry/world.h>

#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

int main() {
    skerry::World world;
    auto rubber = world.add_material({.young_modulus = 5e4, .friction = 0.4, .damping = 20});
    world.add_collider(skerry::Bucket{.radius = 0.3, .height = 1});
    const skerry::Mesh ball = skerry::mesh::ball(0.1, 4);

    // A ball is added every quarter of a second. There are never more than three: the oldest is removed first.
    std::vector<skerry::BodyHandle> balls;
    std::vector<skerry::BodyHandle> removed;
    for (int i = 0; i < 6; ++i) {
        const skerry::Real side = i % 2 == 0 ? 0.05 : -0.05;  // offset that keeps the balls from stacking in a line [m]
        balls.push_back(world.add_body(
            ball, {.material = rubber, .position = {side, 0, 0.7}, .name = "ball " + std::to_string(i)}));
        if (balls.size() > 3) {
            world.remove(balls.front());
            removed.push_back(balls.front());
            balls.erase(balls.begin());
        }
        const skerry::StepReport report = world.advance(0.25);
        if (!report.ok()) throw std::runtime_error(report.message());
    }

    for (const skerry::BodyHandle handle : world.bodies())
        std::cout << world.name(handle) << " is at height " << world.center_of_mass(handle).z() << " m\n";

    bool as_expected = world.bodies() == balls && world.name(balls.front()) == "ball 3" && removed.size() == 3;
    for (const skerry::BodyHandle handle : balls) {
        const skerry::Vec3 center = world.center_of_mass(handle);
        // The ball is in the bucket and has not passed through its floor.
        as_expected = as_expected && world.alive(handle) && center.z() > 0.05 && center.head<2>().norm() < 0.25;
    }
    // A new body may use the memory of a removed one, but never its name.
    for (const skerry::BodyHandle handle : removed) {
        as_expected = as_expected && !world.alive(handle);
        try {
            world.positions(handle);
            as_expected = false;
        } catch (const skerry::SceneError& error) {
            std::cout << "As it should be: " << error.what() << '\n';
        }
    }
    return as_expected ? 0 : 1;
}
