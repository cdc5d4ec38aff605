// One coarse mesh with each kind of element (docs/accuracy.md, item 34).
#include <catch2/catch.hpp>
#include <random>

#include "tests/support/accuracy.h"
#include "tests/support/jittered_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::smoothed_bar_test {

using accuracy::Tolerance;

namespace {

constexpr Real modulus = 1e6, length = 1, height = 0.1;  // Pa, m, m

/// Moves nodes by up to `share` of a cell in each direction. Nodes of the surface stay in it.
Mesh moved(Mesh mesh, Real cell, Real share) {
    std::mt19937_64 random(1);
    for (Vec3& x : mesh.nodes) {
        const Vec3 displacement = share * cell * random_vector(random), half = 0.5 * Vec3(length, height, height);
        for (int i = 0; i < 3; ++i)
            if (std::abs(x[i]) < half[i] - 1e-9) x[i] += displacement[i];
    }
    const MeshReport report = inspect(mesh);
    REQUIRE(report.inverted + report.flat == 0);
    return mesh;
}

/// First period of a bar held at one end [s]
Real first_period(const Mesh& mesh, ElementKind kind, Real nu) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto material = world.add_material(
        lossless({.young_modulus = modulus, .poisson_ratio = nu, .model = MaterialModel::corotational}));
    const auto bar = world.add_body(mesh, {.material = material, .element = kind});
    std::vector<Index> held;
    std::vector<Vec3> velocity(mesh.nodes.size(), Vec3::Zero());
    std::size_t tip = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const Vec3& x = mesh.nodes[n];
        const Real s = x.x() / length + 0.5;
        if (s < 1e-9) held.push_back(static_cast<Index>(n));
        velocity[n].z() = 1e-3 * s * s * (6 - 4 * s + s * s) / 3;  // the shape under its own weight, close to the mode
        const auto from_middle = [](const Vec3& place) { return (place - Vec3(length / 2, 0, 0)).norm(); };
        if (from_middle(x) < from_middle(mesh.nodes[tip])) tip = n;
    }
    world.attach(bar, held);
    world.set_velocities(bar, velocity);
    // The tip passes its rest position after half a period, and again after a whole one.
    std::vector<Real> crossed;
    constexpr Real look = 1e-3;
    Real before = 0;
    while (crossed.size() < 2) {
        REQUIRE(world.advance(look).ok());
        const Real now = world.positions(bar)[tip].z() - mesh.nodes[tip].z();
        if (before * now < 0) crossed.push_back(world.time() - look * now / (now - before));
        before = now;
    }
    return 2 * (crossed[1] - crossed[0]);
}

}  // namespace

TEST_CASE("a coarse clamped bar swings as a fine one does with smoothed elements, and much too fast with linear ones",
          "[scene][accuracy]") {
    // Period of a mesh of quadratic elements that is fine enough for four digits (0.6207 s at 1e7 Pa) [s]
    const Real expected = 0.6207 * std::sqrt(1e7 / modulus);
    const Mesh mesh = mesh::box({length, height, height}, {20, 2, 2});
    for (const auto& [kind, nu, tolerance] : {std::tuple{ElementKind::linear, 0.3, 0.3},
                                              {ElementKind::edge_smoothed, 0.3, 0.04},
                                              {ElementKind::smoothed, 0.3, 0.02},
                                              {ElementKind::linear, 0.45, 0.5},
                                              {ElementKind::edge_smoothed, 0.45, 0.12},
                                              {ElementKind::smoothed, 0.45, 0.04},
                                              {ElementKind::linear, 0.49, 0.7},
                                              {ElementKind::edge_smoothed, 0.49, 0.34},
                                              {ElementKind::smoothed, 0.49, 0.07},
                                              {ElementKind::linear, 0.499, 0.8},
                                              {ElementKind::edge_smoothed, 0.499, 0.67},
                                              {ElementKind::smoothed, 0.499, 0.09}})
        accuracy::check({.item = 34,
                         .name = "first period of a coarse clamped bar (s), Poisson ratio " +
                                 std::to_string(nu).substr(0, 5) + ", " + std::string(name_of(kind)),
                         .formula = "fine mesh of quadratic elements",
                         .expected = expected,
                         .found = first_period(mesh, kind, nu),
                         .tolerance = tolerance});
}

TEST_CASE("a finer clamped bar swings as it should where no cell has the shape of another", "[scene][accuracy]") {
    // Reference: half of the width in quadratic tetrahedra, six per cell, graded towards the held end, with consistent
    // masses: 0.62102, 0.62107, 0.62110, 0.62111 s at 1e7 Pa with 60 x 3 x 6, 60 x 4 x 8, 80 x 5 x 10, 60 x 6 x 12
    // cells, all from below
    const Real expected = 0.6212 * std::sqrt(1e7 / modulus);
    const Mesh mesh = moved(mesh::box({length, height, height}, {40, 4, 4}), height / 4, 0.15);
    for (const auto& [kind, tolerance] : {std::pair{ElementKind::linear, 0.12}, {ElementKind::smoothed, 0.005}})
        accuracy::check(
            {.item = 34,
             .name = "first period of a clamped bar of 40 x 4 x 4 cells, nodes moved at random (s), Poisson "
                     "ratio 0.300, " +
                     std::string(name_of(kind)),
             .formula = "fine mesh of quadratic elements",
             .expected = expected,
             .found = first_period(mesh, kind, 0.3),
             .tolerance = tolerance});
}

}  // namespace skerry::test::smoothed_bar_test
