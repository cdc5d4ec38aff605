// A plate that slides to a stop, that a spring pulls, and that slides under each friction law
// (docs/accuracy.md, items 7, 8 and 28).
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/contact_scene.h"
#include "tests/support/worlds.h"

namespace skerry::test::sliding_test {

using accuracy::Tolerance;

namespace {

constexpr Real mu = 0.3;
constexpr Real g = standard_gravity;

/// A flat plate at rest. Shear makes the faces of a body stop at different times and scales with the square of its
/// height.
BlockOnPlane resting_plate(Friction friction = Friction::cone) {
    Settings settings;
    settings.tolerance = 1e-10;
    settings.max_iterations = 20000;
    settings.friction = friction;
    BlockOnPlane scene(settings, {.young_modulus = 1e6, .poisson_ratio = 0.3, .friction = mu, .damping = 1000},
                       {0.2, 0.2, 0.02}, {4, 4, 1});
    REQUIRE(scene.world.advance(0.3).ok());
    return scene;
}

void push(BlockOnPlane& scene, const Vec3& velocity) {
    scene.world.set_velocities(scene.block, std::vector<Vec3>(scene.mesh.nodes.size(), velocity));
}

struct Stop {
    Vec3 path;  // m
    Real time;  // s
    Real step;  // s
};

Stop slide(BlockOnPlane& scene, const Vec3& velocity) {
    push(scene, velocity);
    const Vec3 start = scene.world.center_of_mass(scene.block);
    const Real begin = scene.world.time(), h = scene.world.stable_step();
    Real stopped = 0;
    while (scene.world.time() - begin < 2) {
        REQUIRE(scene.world.advance(h).ok());
        // Friction reduces the speed by mu g h per step. After the stop only a shear vibration is left.
        if (stopped == 0 && scene.velocity().norm() < mu * g * h) stopped = scene.world.time() - begin;
        if (stopped > 0 && scene.world.time() - begin > stopped + 0.05) break;
    }
    return {scene.world.center_of_mass(scene.block) - start, stopped, h};
}

}  // namespace

TEST_CASE("a sliding plate stops after v^2 / (2 mu g)", "[scene][accuracy]") {
    BlockOnPlane scene = resting_plate();
    const Real v0 = 1;
    const Stop stop = slide(scene, {v0, 0, 0});
    accuracy::check({.item = 7,
                     .name = "sliding stop, distance (m)",
                     .formula = "v0^2 / (2 mu g), tolerance v0 h",
                     .expected = v0 * v0 / (2 * mu * g),
                     .found = stop.path.norm(),
                     .tolerance = v0 * stop.step,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 7,
                     .name = "sliding stop, time (s)",
                     .formula = "v0 / (mu g), tolerance 2 h",
                     .expected = v0 / (mu * g),
                     .found = stop.time,
                     .tolerance = 2 * stop.step,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a plate pulled by a spring breaks away, slips one period and sticks again", "[scene][accuracy]") {
    BlockOnPlane scene = resting_plate();
    const Real m = scene.world.mass(scene.block), stiffness = 100 * m, omega = 10, pull = 0.1;  // kg, N/m, 1/s, m/s
    const Real start = scene.world.center_of_mass(scene.block).x(), begin = scene.world.time(),
               h = scene.world.stable_step();
    std::vector<Vec3> load(scene.mass.size());
    std::vector<Real> crossing;  // times at which the plate has half the speed of the pull [s]
    Real last = 0, peak = 0, moved = 0;
    while (scene.world.time() - begin < mu * g / (omega * omega * pull) + 1.5 * 2 * std::numbers::pi / omega) {
        const Real force =
            stiffness * (pull * (scene.world.time() - begin) - scene.world.center_of_mass(scene.block).x() + start);
        peak = std::max(peak, force);
        for (std::size_t n = 0; n < load.size(); ++n) load[n] = Vec3(force * scene.mass[n] / m, 0, 0);
        scene.world.set_loads(scene.block, load);
        REQUIRE(scene.world.advance(h).ok());
        const Real now = scene.velocity().x();
        if ((last - pull / 2) * (now - pull / 2) < 0)
            crossing.push_back(scene.world.time() - begin - h * (now - pull / 2) / (now - last));
        if (crossing.size() == 2 && moved == 0 && now > last)
            moved = scene.world.center_of_mass(scene.block).x() - start;
        last = now;
    }
    // v = V (1 - cos(omega t')): half of V at omega t' = pi / 3, 2 pi - pi / 3, 2 pi + pi / 3
    REQUIRE(crossing.size() >= 3);
    const Real third = std::numbers::pi / 3 / omega;
    accuracy::check({.item = 8,
                     .name = "friction oscillator, break-away (s)",
                     .formula = "k V t = mu m g",
                     .expected = mu * g / (omega * omega * pull),
                     .found = crossing[0] - third,
                     .tolerance = 0.01});
    accuracy::check({.item = 8,
                     .name = "friction oscillator, force above mu m g (N)",
                     .formula = "V sqrt(k m)",
                     .expected = pull * std::sqrt(stiffness * m),
                     .found = peak - mu * m * g,
                     .tolerance = 0.01});
    accuracy::check(
        {.item = 8,
         .name = "friction oscillator, slip until it sticks again (rad)",
         .formula = "omega t' = 2 pi",
         .expected = 2 * std::numbers::pi,
         .found = omega * ((crossing[1] + crossing[2]) / 2 - crossing[0] + third),
         .tolerance = 0.01,
         .note = "The speed V (1 - cos(omega t')) is measured where it is V / 2; where it touches zero it is flat."});
    accuracy::check({.item = 8,
                     .name = "friction oscillator, way of one slip (m)",
                     .formula = "2 pi V / omega",
                     .expected = 2 * std::numbers::pi * pull / omega,
                     .found = moved,
                     .tolerance = 0.01});
}

TEST_CASE("the pyramid stops a plate on the diagonal with sqrt(2) mu N", "[scene][accuracy]") {
    BlockOnPlane scene = resting_plate(Friction::pyramid);
    const Real v0 = 1, half = std::numbers::sqrt2 / 2;
    const Stop stop = slide(scene, {v0 * half, v0 * half, 0});
    accuracy::check({.item = 28,
                     .name = "pyramid, sliding stop at 45 degrees (m)",
                     .formula = "v0^2 / (2 sqrt(2) mu g), tolerance v0 h",
                     .expected = v0 * v0 / (2 * std::numbers::sqrt2 * mu * g),
                     .found = stop.path.norm(),
                     .tolerance = v0 * stop.step,
                     .kind = Tolerance::absolute});
}

TEST_CASE("pyramid friction keeps to its corners, cone friction to the direction of sliding", "[scene][accuracy]") {
    Real worst_corner = 0, worst_angle = 0, worst_cone = 0;
    for (int k = 0; k < 16; ++k) {
        const Real phi = (k + 0.5) * std::numbers::pi / 8;
        ContactScene scene;
        const Index node = scene.add_node(2, {std::cos(phi), std::sin(phi), -0.5});
        scene.touch_floor(node, mu);
        const Vec3 box = scene.solve({.friction = Friction::pyramid}).impulse[0],
                   round = scene.solve({.friction = Friction::cone}).impulse[0];
        const Vec3 corner(-std::copysign(mu * box.z(), std::cos(phi)), -std::copysign(mu * box.z(), std::sin(phi)),
                          box.z());
        worst_corner = std::max(worst_corner, (box - corner).norm() / box.z());
        const Real along = -(box.x() * std::cos(phi) + box.y() * std::sin(phi)) / box.head<2>().norm();
        const Real folded = std::fmod(phi, std::numbers::pi / 2);
        worst_angle = std::max(worst_angle, std::abs(std::acos(along) - std::abs(std::numbers::pi / 4 - folded)));
        worst_cone = std::max(
            worst_cone, (round - mu * round.z() * Vec3(-std::cos(phi), -std::sin(phi), 1 / mu)).norm() / round.z());
    }
    accuracy::check({.item = 28,
                     .name = "pyramid, impulse over N, worst of 16 directions",
                     .formula = "-mu N (sgn cos, sgn sin)",
                     .found = worst_corner,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 28,
                     .name = "pyramid, misalignment, worst of 16 directions (rad)",
                     .formula = "|pi/4 - phi|",
                     .found = worst_angle,
                     .tolerance = 1e-7,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 28,
                     .name = "cone, impulse over N, worst of 16 directions",
                     .formula = "-mu N (cos, sin)",
                     .found = worst_cone,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a plate slows down alike in 16 directions under the cone", "[scene][accuracy]") {
    BlockOnPlane rest = resting_plate();
    Real worst = 0;
    for (int k = 0; k < 16; ++k) {
        BlockOnPlane scene = resting_plate();
        const Real phi = k * std::numbers::pi / 8;
        push(scene, {std::cos(phi), std::sin(phi), 0});
        REQUIRE(scene.world.advance(0.1).ok());  // until the shear due to friction has developed
        const Vec3 before = scene.velocity();
        REQUIRE(scene.world.advance(0.1).ok());
        worst = std::max(worst, std::abs((before - scene.velocity()).norm() / 0.1 / (mu * g) - 1));
    }
    accuracy::check({.item = 28,
                     .name = "cone, deceleration of a plate over mu g - 1, worst of 16 directions",
                     .formula = "0",
                     .found = worst,
                     .tolerance = 1e-6,
                     .kind = Tolerance::absolute});
}

}  // namespace skerry::test::sliding_test
