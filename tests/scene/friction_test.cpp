// A block at rest on the floor. accuracy/incline_test.cpp and accuracy/sliding_test.cpp test friction itself.
#include <catch2/catch.hpp>

#include "tests/support/worlds.h"

namespace skerry::test::friction_test {

namespace {

MaterialSettings block_material() {
    return {.young_modulus = 2e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.3, .damping = 300};
}

}  // namespace

TEST_CASE("the floor carries the weight of a resting block", "[scene]") {
    Settings settings = accurate({0, 0, -standard_gravity});
    BlockOnPlane scene(settings, block_material());
    scene.settle(1.0);
    const StepReport report = scene.world.advance(1e-4);
    REQUIRE(report.ok());
    Vec3 force = Vec3::Zero();
    for (const Contact& contact : scene.world.contacts()) force += contact.force();
    const Real weight = scene.world.mass(scene.block) * standard_gravity;
    CHECK(force.z() == Approx(weight).epsilon(1e-3));
    CHECK(std::abs(force.x()) < 1e-3 * weight);
}

}  // namespace skerry::test::friction_test
