// Includes every public header of Skerry and drops a ball.
#include <skerry/error.h>
#include <skerry/instruction_set.h>
#include <skerry/mesh.h>
#include <skerry/output.h>
#include <skerry/problem.h>
#include <skerry/report.h>
#include <skerry/scene.h>
#include <skerry/settings.h>
#include <skerry/world.h>

#include <cmath>

#include "components/types.h"

double own_vectors();

int main() {
    skerry::World world({.threads = 2});
    auto rubber = world.add_material({.young_modulus = 1e5});
    auto ball = world.add_body(skerry::mesh::ball(0.1, 4), {.material = rubber, .position = {0, 0, 1}});
    world.add_collider(skerry::Plane{});
    const skerry::Real mass = world.mass(ball);
    const Mine frames = 20;
    for (int i = 0; i < frames; ++i)
        if (!world.advance(0.01).ok()) return 1;
    // Free fall: z = 1 - g t^2 / 2, to first order in the step.
    const skerry::Real fallen = 1 - world.center_of_mass(ball).z();
    if (std::abs(fallen - 0.5 * 9.81 * 0.04) > 0.01) return 2;
    if (!(mass > 0) || world.state_hash() == 0) return 3;
    return own_vectors() == 1000 ? 0 : 4;
}
