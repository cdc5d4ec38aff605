// A bar twisted by half a turn with each kind of element (docs/accuracy.md, item 36).
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/mapped_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::twisted_bar_test {

namespace {

// [m, m, Pa, s]
constexpr Real length = 1, width = 0.2, modulus = 1e5, turning = 2;

/// Elastic energy of a bar of 20 x 4 x 4 cells at rest after its end has turned [J]
Real energy(ElementKind kind, Real nu) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    // The damping is about critical for bending.
    const auto material = world.add_material(lossless({.young_modulus = modulus, .poisson_ratio = nu, .damping = 30}));
    const Mesh mesh = mesh::box({length, width, width}, {20, 4, 4});
    const auto bar = world.add_body(mesh, {.material = material, .element = kind});
    world.attach(bar, nodes_where(mesh, [](const Vec3& x) { return x.x() < -length / 2 + 1e-9; }));
    Motion half_turn;
    for (int k = 0; k <= 40; ++k) {
        const Real s = k / 40.0, part = s * s * (3 - 2 * s);
        half_turn.keys.push_back({turning * s, Vec3::Zero(), {std::numbers::pi * part, 0, 0}});
    }
    world.attach(bar, nodes_where(mesh, [](const Vec3& x) { return x.x() > length / 2 - 1e-9; }), half_turn);
    REQUIRE(world.advance(turning).ok());
    settle(world, 0.2);
    const WorldReport report = world.report();
    REQUIRE(report.inversions == 0);  // no inversion in any step
    REQUIRE(report.folded == 0);
    return world.energy().elastic;
}

}  // namespace

TEST_CASE("a bar is twisted by half a turn", "[scene][accuracy]") {
    // Reference [J]: quadratic tetrahedra, six per cell, by Newton's method: 40.767, 39.290, 39.110 with 10, 20, 30
    // cells along the bar, 39.227, 39.074 with 16 and 24 graded towards the ends (Richardson, with the observed order).
    // Smoothed elements converge to it: 41.285, 39.238, 39.051 with 20, 40, 60 cells. Linear elements converge more
    // slowly: 53.564, 42.894, 40.795. They are 37 % too high on this mesh.
    constexpr Real expected = 39.0;
    for (const auto& [kind, tolerance] : {std::pair{ElementKind::linear, 0.38}, {ElementKind::smoothed, 0.06}})
        accuracy::check({.item = 36,
                         .name = "bar twisted by half a turn, energy (J), " + std::string(name_of(kind)),
                         .formula = "fine mesh of quadratic elements",
                         .expected = expected,
                         .found = energy(kind, 0.45),
                         .tolerance = tolerance});
}

}  // namespace skerry::test::twisted_bar_test
