// A block on an incline against Coulomb's law (docs/accuracy.md, item 6), at several sizes.
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::incline_test {

using accuracy::Tolerance;

namespace {

constexpr Real mu = 0.3;
const Real critical_degrees = std::atan(mu) * 180 / std::numbers::pi;

Settings on_incline(Real degrees, ContactRegions regions = ContactRegions::separate) {
    Settings settings;
    settings.gravity = tilted_gravity(degrees);
    settings.contact_regions = regions;
    settings.tolerance = 1e-10;
    settings.max_iterations = 20000;
    settings.sleep = false;  // friction must hold the block, not sleep
    return settings;
}

/// A block of height `height` that has come to rest and is then tilted slowly. The decay rate of its deformation scales
/// with its frequencies.
BlockOnPlane settled_block(const Settings& settings, Real height = 0.1) {
    BlockOnPlane scene(settings, {.young_modulus = 2e5, .poisson_ratio = 0.3, .friction = mu, .damping = 30 / height},
                       height * Vec3(2, 2, 1));
    scene.settle(0.5 + height, 1.0);
    return scene;
}

Real expected_acceleration(Real degrees) {
    const Real a = degrees * std::numbers::pi / 180;
    return standard_gravity * (std::sin(a) - mu * std::cos(a));
}

Real acceleration(BlockOnPlane& scene) {
    REQUIRE(scene.world.advance(0.5).ok());
    const Vec3 before = scene.velocity();
    REQUIRE(scene.world.advance(0.5).ok());
    return (scene.velocity().x() - before.x()) / 0.5;
}

}  // namespace

TEST_CASE("a block sticks a hundredth of a degree below the friction angle, without creep", "[scene][accuracy]") {
    for (ContactRegions regions : {ContactRegions::separate, ContactRegions::global}) {
        BlockOnPlane scene = settled_block(on_incline(critical_degrees - 0.01, regions));
        // The end of the tilt makes the block slip at some mm/s; g (sin a - mu cos a) = -0.0018 m/s^2 stops it.
        REQUIRE(scene.world.advance(3.0).ok());
        const Vec3 start = scene.world.center_of_mass(scene.block);
        REQUIRE(scene.world.advance(1.0).ok());
        const std::string regions_text = ", regions " + std::string(name_of(regions));
        const Real slip = (scene.world.center_of_mass(scene.block) - start).norm();
        accuracy::check({.item = 6,
                         .name = "incline 0.01 degree below critical, slip in 1 s (m)" + regions_text,
                         .formula = "0 while tan(a) <= mu",
                         .found = slip,
                         .tolerance = 1e-6,
                         .kind = Tolerance::absolute});
        Real creep = slip / 1.0;
        for (const Vec3& v : scene.world.velocities(scene.block)) creep = std::max(creep, v.norm());
        accuracy::check({.item = 6,
                         .name = "the same, creep: fastest node, or mean over 1 s (m/s)" + regions_text,
                         .formula = "0 while tan(a) <= mu",
                         .found = creep,
                         .tolerance = 1e-9,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("a block slides above the friction angle with g (sin a - mu cos a)", "[scene][accuracy]") {
    for (Real degrees : {critical_degrees + 0.01, 20.0, 30.0})
        for (ContactRegions regions : {ContactRegions::separate, ContactRegions::global}) {
            BlockOnPlane scene = settled_block(on_incline(degrees, regions));
            const bool critical = degrees < 17;
            accuracy::check({.item = 6,
                             .name = std::string("incline ") +
                                     (critical        ? "0.01 degree above critical"
                                      : degrees == 20 ? "at 20 degrees"
                                                      : "at 30 degrees") +
                                     ", acceleration (m/s^2), regions " + std::string(name_of(regions)),
                             .formula = "g (sin a - mu cos a)",
                             .expected = expected_acceleration(degrees),
                             .found = acceleration(scene),
                             .tolerance = critical ? 0.01 : 0.001});
        }
}

TEST_CASE("a block slides alike at 1 m, 10 cm and 1 cm", "[scene][accuracy]") {
    for (Real height : {1.0, 0.1, 0.01}) {
        BlockOnPlane scene = settled_block(on_incline(20), height);
        accuracy::check({.item = 6,
                         .name = "incline at 20 degrees, block " + std::to_string(static_cast<int>(100 * height)) +
                                 " cm high, acceleration (m/s^2)",
                         .formula = "g (sin a - mu cos a)",
                         .expected = expected_acceleration(20),
                         .found = acceleration(scene),
                         .tolerance = 0.001});
    }
}

}  // namespace skerry::test::incline_test
