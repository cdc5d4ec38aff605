// A block on an incline and on a floor against Coulomb's law (methods.md 8, items 6, 7, 28, 29).
#include <catch2/catch.hpp>

#include "tests/support/worlds.h"

using namespace skerry;
using namespace skerry::test;

namespace {

constexpr Real mu = 0.3;
const Real critical_degrees = std::atan(mu) * 180 / std::numbers::pi;

MaterialSettings block_material() {
    return {.young_modulus = 2e5, .poisson_ratio = 0.3, .density = 1000, .friction = mu, .damping = 300};
}

Settings accurate(const Vec3& gravity) {
    Settings settings;
    settings.gravity = gravity;
    settings.tolerance = 1e-8;
    settings.max_iterations = 20000;
    return settings;
}

}  // namespace

TEST_CASE("a block stays put 0.1 degree below the friction angle", "[scene]") {
    const ContactRegions regions = GENERATE(ContactRegions::separate, ContactRegions::global);
    Settings settings = accurate(tilted_gravity(critical_degrees - 0.1));
    settings.contact_regions = regions;
    BlockOnPlane scene(settings, block_material());
    scene.settle(0.5);
    REQUIRE(scene.world.advance(0.5).ok());  // the shear of the tilt settles
    const Vec3 start = scene.world.center_of_mass(scene.block);
    REQUIRE(scene.world.advance(1.0).ok());
    CHECK((scene.world.center_of_mass(scene.block) - start).norm() < 1e-6);
}

TEST_CASE("a block slides above the friction angle with g (sin a - mu cos a)", "[scene]") {
    const ContactRegions regions = GENERATE(ContactRegions::separate, ContactRegions::global);
    const Real degrees = GENERATE(critical_degrees + 0.1, 20.0, 30.0);
    Settings settings = accurate(tilted_gravity(degrees));
    settings.contact_regions = regions;
    BlockOnPlane scene(settings, block_material());
    scene.settle(0.5);
    REQUIRE(scene.world.advance(0.3).ok());
    const Vec3 v0 = scene.velocity();
    const Real seconds = 0.5;
    REQUIRE(scene.world.advance(seconds).ok());
    const Real a = degrees * std::numbers::pi / 180;
    const Real expected = standard_gravity * (std::sin(a) - mu * std::cos(a));
    // 1 % of the acceleration; 0.1 degree above the angle that is 1 % of 0.018 m/s^2
    CHECK((scene.velocity().x() - v0.x()) / seconds == Approx(expected).epsilon(0.01));
    CHECK(std::abs(scene.velocity().y()) < 1e-6);
}

TEST_CASE("separate and global regions give the same bits with fixed sweeps", "[scene][determinism]") {
    std::vector<std::uint64_t> hashes;
    for (ContactRegions regions : {ContactRegions::separate, ContactRegions::global}) {
        Settings settings;
        settings.gravity = tilted_gravity(20);
        settings.contact_regions = regions;
        settings.method = SolverMethod::pgs;  // acceleration looks at the whole region
        settings.method = SolverMethod::pgs;  // acceleration looks at the whole region
        settings.fixed_iterations = true;
        settings.max_iterations = 10;
        World world(settings);
        const auto material = world.add_material(block_material());
        world.add_collider(Plane{});
        world.add_body(mesh::box({0.2, 0.2, 0.1}, {3, 3, 2}), {.material = material, .position = {0, 0, 0.051}, .contact_distance = 0.002});
        world.add_body(mesh::ball(0.05, 5), {.material = material, .position = {0, 0, 0.153}, .contact_distance = 0.002});
        world.add_body(mesh::ball(0.05, 5), {.material = material, .position = {0.3, 0, 0.052}, .contact_distance = 0.002});
        REQUIRE(world.advance(0.1).ok());
        REQUIRE(world.report().max_contacts > 10);
        if (regions == ContactRegions::separate) REQUIRE(world.report().max_regions > 5);
        hashes.push_back(world.state_hash());
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a sliding block stops after v^2 / (2 mu g)", "[scene]") {
    Settings settings = accurate({0, 0, -standard_gravity});
    BlockOnPlane scene(settings, block_material());
    scene.settle(0.5);
    const Real v0 = 1;
    std::vector<Vec3> velocity(scene.mesh.nodes.size(), Vec3(v0, 0, 0));
    scene.world.set_velocities(scene.block, velocity);
    const Vec3 start = scene.world.center_of_mass(scene.block);
    REQUIRE(scene.world.advance(v0 / (mu * standard_gravity) + 0.2).ok());
    const Real distance = v0 * v0 / (2 * mu * standard_gravity);
    // The block shears elastically when friction sets in and when it stops: a few per cent of a body this soft.
    CHECK(scene.world.center_of_mass(scene.block).x() - start.x() == Approx(distance).epsilon(0.02));
    CHECK(scene.velocity().norm() < 1e-3);
}

TEST_CASE("the floor carries the weight of a resting block", "[scene]") {
    Settings settings = accurate({0, 0, -standard_gravity});
    BlockOnPlane scene(settings, block_material());
    scene.settle(1.0);
    const StepReport report = scene.world.advance(1e-4);
    REQUIRE(report.ok());
    Vec3 impulse = Vec3::Zero();
    for (const Contact& contact : scene.world.contacts()) impulse += contact.impulse;
    const Real weight = scene.world.mass(scene.block) * standard_gravity;
    CHECK(impulse.z() / report.step_size == Approx(weight).epsilon(1e-3));
    CHECK(std::abs(impulse.x()) / report.step_size < 1e-3 * weight);
}
