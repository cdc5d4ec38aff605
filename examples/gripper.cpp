// Two fingers grip a soft ball and lift it. Positions and velocities are set every millisecond, and the force is read
// from the contacts.
#include <skerry/world.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

using namespace skerry;

int main() {
    World world;
    auto rubber = world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.8, .damping = 20});
    auto ball = world.add_body(mesh::ball(0.05, 6), {.material = rubber, .position = {0, 0, 0.052}});
    world.add_collider(Plane{});
    const Real open = 0.07, half = 0.01;  // distance of the centres of finger and ball; half a finger's thickness [m]
    std::array<ColliderHandle, 2> finger;
    for (int i = 0; i < 2; ++i)
        finger[i] = world.add_collider(Box{{2 * half, 0.04, 0.04}}, {.position = {i ? open : -open, 0, 0.05}});

    Vec3 impulse = Vec3::Zero();  // on the right finger, over the steps of one millisecond [N s]
    world.watch_steps([&](const StepReport&) {
        for (const Contact& contact : world.contacts())
            if (contact.collider == finger[1]) impulse -= contact.impulse;
    });
    const Real dt = 1e-3, wanted = 4;   // [s], [N]
    Real grip = 0, mean = 0, lift = 0;  // [N], [m]
    Real apart = open;                  // [m]
    for (int ms = 0; ms < 2000; ++ms) {
        // Close until the force reaches `wanted`. Then move up at 0.1 m/s for one second and stay there.
        const Real closing = std::clamp(0.02 * (wanted - mean), -0.05, 0.05);  // [m/s]
        apart -= dt * closing;
        lift += ms > 700 && ms < 1700 ? 0.1 * dt : 0;
        for (int i = 0; i < 2; ++i) world.move_to(finger[i], {.position = {i ? apart : -apart, 0, 0.05 + lift}}, dt);
        impulse.setZero();
        if (const StepReport report = world.advance(dt); !report.ok()) throw std::runtime_error(report.message());
        grip = impulse.x() / dt;
        mean += 0.05 * (grip - mean);
        if (ms % 200 == 199)
            std::printf("%4d ms: fingers press with %5.2f N, %4.1f mm apart; the ball is at z = %5.1f mm\n", ms + 1,
                        mean, 1000 * 2 * (apart - half), 1000 * world.center_of_mass(ball).z());
    }
    return world.center_of_mass(ball).z() > 0.14 && std::abs(mean - wanted) < 0.5 ? 0 : 1;
}
