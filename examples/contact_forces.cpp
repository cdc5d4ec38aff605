// Contact forces: the contacts of a block on a slope carry its weight, and friction holds it.
#include <skerry/world.h>

#include <cmath>
#include <iostream>
#include <stdexcept>

int main() {
    const skerry::Real slope = 0.3;  // below the friction angle atan(0.5) = 0.46 [rad]
    skerry::World world;
    auto rubber = world.add_material({.young_modulus = 2e5, .density = 1000, .friction = 0.5, .damping = 50});
    auto block =
        world.add_body(skerry::mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), {.material = rubber, .position = {0, 0, 0.0505}});
    world.add_collider(skerry::Plane{.normal = {0, 0, 1}});
    // The floor is the slope: gravity is tilted instead of the plane.
    world.set_gravity({9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)});

    // Let the block settle. Then sum up the contact impulses of every single step for half a second.
    skerry::StepReport report = world.advance(1.5);
    skerry::Vec3 impulse = skerry::Vec3::Zero();  // on the block [N s]
    const skerry::Real start = world.time();
    int sticking = 0, sliding = 0;
    while (report.ok() && world.time() < start + 0.5) {
        report = world.advance(world.stable_step());
        for (const skerry::Contact& contact : world.contacts()) {
            impulse += contact.impulse;
            if (contact.motion == skerry::ContactMotion::stick) ++sticking;
            if (contact.motion == skerry::ContactMotion::slide) ++sliding;
        }
    }
    if (!report.ok()) throw std::runtime_error(report.message());

    const skerry::Vec3 force = impulse / (world.time() - start);               // mean [N]
    const skerry::Vec3 weight = world.mass(block) * world.settings().gravity;  // [N]
    std::cout << "The block weighs " << weight.norm() << " N; the floor pushes with " << force.z()
              << " N and holds with " << -force.x() << " N of friction.\n"
              << sticking << " contacts stuck and " << sliding << " slid.\n";

    // At rest the contacts carry the weight. The oscillation that remains in half a second is below one percent.
    const bool as_expected = (force + weight).norm() < 0.01 * weight.norm() && sticking > 0;
    return as_expected ? 0 : 1;
}
