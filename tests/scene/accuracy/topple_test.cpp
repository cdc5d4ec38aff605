// Blocks that topple, discs that spin down, balls that begin to roll (docs/accuracy.md, items 24 to 26).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::topple_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity;
constexpr Real degree = std::numbers::pi / 180;

/// Behaviour of a block of width b and height h on an incline, a second after the tilt: it has toppled, slid away, or
/// neither.
enum class Fate { rests, slides, topples };

Fate fate(Real degrees, Real mu) {
    constexpr Real b = 0.1, h = 0.2;
    Settings settings = accurate();
    settings.gravity = tilted_gravity(degrees);
    BlockOnPlane scene(settings, {.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = mu, .damping = 500},
                       {b, b, h}, {2, 2, 4});
    scene.settle(0.2, 0.5);
    const Vec3 start = scene.world.center_of_mass(scene.block);
    REQUIRE(scene.world.advance(2.0).ok());
    const Vec3 displacement = scene.world.center_of_mass(scene.block) - start;
    if (std::abs(displacement.z()) > 0.1 * b) return Fate::topples;
    return displacement.norm() > 0.1 * b ? Fate::slides : Fate::rests;
}

}  // namespace

TEST_CASE("a block topples where tan(a) > b / h, if friction holds it", "[scene][accuracy]") {
    const Real critical = std::atan(0.5) / degree;
    // Bisects to 0.01 degree between the largest angle at which it stands and the smallest at which it topples.
    Real stands = critical - 1, topples = critical + 1;
    REQUIRE(fate(stands, 0.8) == Fate::rests);
    REQUIRE(fate(topples, 0.8) == Fate::topples);
    while (topples - stands > 0.02) {
        const Real middle = (stands + topples) / 2;
        (fate(middle, 0.8) == Fate::topples ? topples : stands) = middle;
    }
    accuracy::check(
        {.item = 24,
         .name = "block of b / h = 1 / 2, mu = 0.8, angle at which it topples (degrees)",
         .formula = "atan(b / h)",
         .expected = critical,
         .found = (stands + topples) / 2,
         .tolerance = 0.1,
         .kind = Tolerance::absolute,
         .note =
             "Found by halving. An elastic block stands on an edge that gives way, which lowers the angle a little."});
    Real rests = std::atan(0.3) / degree - 0.5, slides = rests + 1;
    REQUIRE(fate(rests, 0.3) == Fate::rests);
    REQUIRE(fate(slides, 0.3) == Fate::slides);
    accuracy::check({.item = 24,
                     .name = "the same block, mu = 0.3: it slides at atan(mu) + 0.5 degree and stands upright, 1 = yes",
                     .formula = "mu < b / h",
                     .expected = 1,
                     .found = fate(slides + 5, 0.3) == Fate::slides ? 1.0 : 0.0,
                     .tolerance = 0,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a spinning disc comes to rest after 3 omega R / (4 mu g)", "[scene][accuracy]") {
    constexpr Real radius = 0.1, height = 0.02, mu = 0.3, omega = 20;
    World world(accurate());
    const auto material =
        world.add_material({.young_modulus = 2e6, .poisson_ratio = 0.3, .friction = mu, .damping = 300});
    world.add_collider(Plane{});
    const Mesh mesh = mesh::cylinder(radius, height, 16);
    const auto disc = world.add_body(
        mesh, {.material = material, .position = {0, 0, height / 2 + 0.0005}, .contact_distance = 0.001});
    const std::vector<Real> mass = node_masses(world, disc, mesh, 1000);
    REQUIRE(world.advance(0.1).ok());
    std::vector<Vec3> velocity;
    Real inertia = 0;
    for (const Vec3& x : world.positions(disc)) {
        velocity.push_back(Vec3(0, 0, omega).cross(x));
        inertia += mass[velocity.size() - 1] * x.head<2>().squaredNorm();
    }
    world.set_velocities(disc, velocity);
    const auto spin = [&] {
        Real sum = 0;
        for (std::size_t n = 0; n < mass.size(); ++n)
            sum += mass[n] * world.positions(disc)[n].cross(world.velocities(disc)[n]).z();
        return sum / inertia;
    };
    const Real begin = world.time(), expected = 3 * omega * radius / (4 * mu * g);
    const Real before = spin();
    REQUIRE(world.advance(0.8 * expected).ok());
    const Real torque = inertia * (before - spin()) / (0.8 * expected), left = spin();
    while (spin() > 0.01 * omega && world.time() < begin + 2 * expected) REQUIRE(world.advance(1e-4).ok());
    const Real weight = world.mass(disc) * g;
    accuracy::check({.item = 25,
                     .name = "spinning disc, mean torque (N m)",
                     .formula = "(2/3) mu N R",
                     .expected = 2.0 / 3 * mu * weight * radius,
                     .found = torque,
                     .tolerance = 0.02});
    // Extrapolates the last hundredth of the spin at the rate so far.
    const Real stop = (world.time() - begin) * omega / (omega - spin());
    INFO("spin left at 80 %: " << left);
    accuracy::check({.item = 25,
                     .name = "spinning disc, time until it stops (s)",
                     .formula = "3 omega0 R / (4 mu g)",
                     .expected = expected,
                     .found = stop,
                     .tolerance = 0.02});
}

TEST_CASE("a sliding ball ends up rolling with 5/7 of its speed", "[scene][accuracy]") {
    constexpr Real radius = 0.1, mu = 0.2, v0 = 2;
    World world(accurate());
    const auto material =
        world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = mu, .damping = 30});
    world.add_collider(Plane{});
    const Mesh mesh = mesh::ball(radius, 16);
    const auto ball =
        world.add_body(mesh, {.material = material, .position = {0, 0, radius + 0.0005}, .contact_distance = 0.001});
    const std::vector<Real> mass = node_masses(world, ball, mesh, 1000);
    REQUIRE(world.advance(0.2).ok());
    const Vec3 start = world.center_of_mass(ball);
    world.set_velocities(ball, std::vector<Vec3>(mass.size(), Vec3(v0, 0, 0)));
    const Real begin = world.time(), expected = 2 * v0 / (7 * mu * g);
    Real rolls = 0, speed = 0, way = 0;
    for (Real t = 0; t < 1.5 * expected; t += 1e-3) {
        REQUIRE(world.advance(1e-3).ok());
        const Real v = mean_velocity(world, ball, mass).x();
        Real spin = 0, inertia = 0;
        const Vec3 center = world.center_of_mass(ball);
        for (std::size_t n = 0; n < mass.size(); ++n) {
            const Vec3 arm = world.positions(ball)[n] - center;
            spin += mass[n] * arm.cross(world.velocities(ball)[n]).y();
            inertia += mass[n] * (arm.x() * arm.x() + arm.z() * arm.z());
        }
        if (rolls == 0 && v <= spin / inertia * center.z()) {
            rolls = world.time() - begin;
            speed = v;
            way = center.x() - start.x();
        }
    }
    accuracy::check({.item = 26,
                     .name = "sliding ball, speed when it rolls (m/s)",
                     .formula = "(5/7) v0",
                     .expected = 5.0 / 7 * v0,
                     .found = speed,
                     .tolerance = 0.02});
    accuracy::check({.item = 26,
                     .name = "sliding ball, time until it rolls (s)",
                     .formula = "2 v0 / (7 mu g)",
                     .expected = expected,
                     .found = rolls,
                     .tolerance = 0.02});
    accuracy::check({.item = 26,
                     .name = "sliding ball, way until it rolls (m)",
                     .formula = "12 v0^2 / (49 mu g)",
                     .expected = 12 * v0 * v0 / (49 * mu * g),
                     .found = way,
                     .tolerance = 0.02});
}

}  // namespace skerry::test::topple_test
