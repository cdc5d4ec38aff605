// What has levels with multirate, and how calls are cut into cycles (docs/methods/clusters.md 5.1,
// docs/methods/stable_step.md 7.7).
#include <catch2/catch.hpp>

#include "tests/support/multirate_worlds.h"

namespace skerry::test::multirate_choice_test {

TEST_CASE("with multirate slivers become implicit where that saves more than levels", "[scene]") {
    // what bounds the steps of all: as without multirate, but for the order of sums (BlockOrder)
    std::vector<std::uint64_t> steps;
    std::vector<Vec3> corner;
    for (const bool multirate : {false, true}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.multirate = multirate;
        World world(settings);
        const auto material = world.add_material(test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3}));
        const auto body = world.add_body(sliver_mesh(), {.material = material, .element = ElementKind::linear});
        stir(world, body, sliver_mesh());
        REQUIRE(world.advance(0.02).ok());
        const WorldReport report = world.report();
        CHECK(report.clusters > 0);
        if (multirate) CHECK(report.level_elements.size() == 1);
        steps.push_back(report.steps);
        corner.push_back(world.positions(body)[0]);
    }
    CHECK(steps[0] == steps[1]);
    CHECK((corner[0] - corner[1]).norm() < 1e-12);
}

TEST_CASE("a soft body with slivers has clusters for the sake of its own steps under a stiff one", "[scene]") {
    const auto integrator = GENERATE(Integrator::symplectic_euler, Integrator::leapfrog);
    World world = ball_on_slivers(true, integrator), single = ball_on_slivers(false, integrator);
    REQUIRE(world.advance(0.1).ok());
    REQUIRE(single.advance(0.1).ok());
    const WorldReport report = world.report(), without = single.report();
    CHECK(report.clusters > 0);
    CHECK(report.max_contacts > 5);
    CHECK(report.element_impulses < report.element_steps / 2);
    CHECK(report.energy_error_share < 0.01);
    CHECK(report.max_penetration <= without.max_penetration + 1e-5);
    for (std::size_t i = 0; i < world.bodies().size(); ++i)
        CHECK((world.center_of_mass(world.bodies()[i]) - single.center_of_mass(single.bodies()[i])).norm() < 5e-4);
}

TEST_CASE("smoothed elements have one level, since they would gain energy with several", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.clusters = false;
    settings.multirate = true;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3}));
    const auto kind = GENERATE(ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    stir(world, world.add_body(sliver_mesh(), {.material = material, .element = kind}), sliver_mesh());
    const Real start = total_energy(world);
    REQUIRE(world.advance(0.02).ok());
    CHECK(world.report().level_elements.size() == 1);
    CHECK(world.report().energy_error_share < 1e-3);
    CHECK(total_energy(world) < 1.01 * start);
}

TEST_CASE("short calls pump up nothing that stands a few steps", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.multirate = true;
    World world(settings);
    const auto rubber = [&](Real modulus) {
        return world.add_material(test::lossless({.young_modulus = modulus, .poisson_ratio = 0.3}));
    };
    // one tetrahedron, whose bound is sharp; soft ones have own steps of 4.05 of the stiff one
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    const auto stiff = rubber(16.4e5), soft = rubber(1e5);
    world.add_body(mesh, {.material = stiff, .position = {1, 0, 0}, .element = ElementKind::linear});
    for (int i = 0; i < 4; ++i)
        stir(world,
             world.add_body(mesh, {.material = soft, .position = {0, 0.5 * i, 0}, .element = ElementKind::linear}),
             mesh, 0.02);
    const Real start = total_energy(world), h = world.stable_step();
    const int steps = GENERATE(5, 7, 13);
    INFO("calls of " << steps << " steps");
    // A cycle of four steps and one of what is left, over and over, were in time with the highest modes.
    for (int call = 0; call < 400; ++call) {
        REQUIRE(world.advance(0.999 * steps * h).ok());
        REQUIRE(total_energy(world) < 2 * start);
    }
    CHECK(10 * world.report().element_impulses < 9 * world.report().element_steps);
    CHECK(world.report().energy_error_share < 0.01);
}

}  // namespace skerry::test::multirate_choice_test
