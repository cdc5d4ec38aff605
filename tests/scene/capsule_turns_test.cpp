// Reduction of contact distances by the rotation of a capsule within a step (docs/methods/rigid_bodies.md 6.2).
#include <catch2/catch.hpp>

#include "tests/support/capsules.h"

namespace skerry::test::capsule_turns_test {

using namespace skerry::test::capsules;

TEST_CASE("a capsule that spins on its end does not enter the surface below", "[scene]") {
    for (const Floor floor : {plane, box, mesh_collider, rigid_slab}) {
        CAPTURE(floor);
        Capsules c(steps_of(2e-3, Vec3::Zero()), 0);
        // The capsule is nearly flat. It turns about an axis that leans over its lower end and moves the end down.
        constexpr Real tilt = 0.1;
        const Vec3 axis(std::cos(tilt), 0, -std::sin(tilt)), turn = 50 / std::sqrt(2.0) * Vec3(-1, 0, 1);
        const Vec3 spin = turn + (across / axial - 1) * turn.dot(axis) * axis;
        const Real end = radius + add_floor(c, floor);
        const BodyHandle body =
            c.add({0, 0.03, end + length / 2 * std::sin(tilt)}, {0, pi / 2 + tilt, 0}, Vec3::Zero(), spin);
        Real lowest = end;
        for (int step = 0; step < 40; ++step) {
            REQUIRE(c.world.advance(2e-3).ok());
            lowest = std::min({lowest, c.end(body, 0).z(), c.end(body, 1).z()});
        }
        CHECK(c.middle(body).z() > end + length / 2 * std::sin(tilt));
        CHECK(c.world.report().crossings_found == 0);
        CHECK(lowest > end - 1e-6);
    }
}

}  // namespace skerry::test::capsule_turns_test
