#include <catch2/catch.hpp>

#include "systems/solver/local/push_contact.h"
#include "tests/support/contact_scene.h"

namespace skerry::test::solver_push_out_test {

TEST_CASE("a contact that is pressed in is moved out without gaining velocity", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0.1, 0, -0.2)), 0.5);
    const SolvedScene touching = scene.solve();
    const auto pushed_by = [&scene](Real gap, const SolverSettings& settings) {
        scene.gap[0] = gap;
        const SolvedScene pressed = scene.solve(settings);
        CHECK(pressed.push_out[0].head<2>().norm() == 0);
        return pressed.push_out[0].z();
    };
    SolverSettings settings;
    settings.recovery = 0.2;
    CHECK(pushed_by(-1e-3, settings) == Approx(0.01 * 0.5));
    CHECK(pushed_by(-0.01, settings) == Approx(0.03 * std::sqrt(9.81 * 0.01)));
    CHECK(pushed_by(-0.1, settings) == Approx(0.03 * std::sqrt(9.81 * 0.1)));
    CHECK(scene.solve(settings).velocity == touching.velocity);
    CHECK(scene.solve(settings).impulse == touching.impulse);
    settings.recovery_speed = 1e-3;
    CHECK(pushed_by(-0.1, settings) == Approx(1e-3));
    settings.recovery_speed = 0.5;
    scene.gravity = 0;
    CHECK(pushed_by(-0.1, settings) == Approx(0.01 * 0.5));
    CHECK(pushed_by(-1e-7, settings) == Approx(0.2 * 1e-7 / 1e-3));  // a share of the gap per step never goes too far
}

TEST_CASE("the split impulse adds no kinetic energy", "[property][solver]") {
    ContactScene scene;
    add_sheets(scene, 7, 0.5, 3);
    const SolvedScene touching = scene.solve();
    for (std::size_t i = 0; i < scene.gap.size(); ++i)
        if (i % 3 == 0) scene.gap[i] = -2e-3;
    const SolvedScene pressed = scene.solve();
    CHECK(pressed.velocity == touching.velocity);
    Real moved = 0;
    for (const Vec3& p : pressed.push_out) moved += p.norm();
    CHECK(moved > 0);
}

TEST_CASE("the push takes every pressed contact out and presses no other in", "[property][solver]") {
    ContactScene scene;
    add_sheets(scene, 7, 0.5, 4);
    for (std::size_t i = 0; i < scene.gap.size(); ++i) scene.gap[i] = i % 4 == 0 ? -1e-3 : i % 4 == 1 ? 1e-4 : 0;
    SolverSettings settings;
    settings.tolerance = 1e-9;
    settings.max_iterations = 100000;
    const SolvedScene solved = scene.solve(settings);
    for (std::size_t i = 0; i < scene.gap.size(); ++i) {
        const Real along = scene.relative_velocity(i, solved.velocity).dot(scene.normal[i]) +
                           scene.relative_velocity(i, solved.push_out).dot(scene.normal[i]);
        const Real least = scene.gap[i] < 0 ? 0.01 * 0.5 : -scene.gap[i] / scene.h;
        CHECK(along > least - 1e-6);
    }
}

TEST_CASE("gaps within the slop are not pushed, and a push is taken back in the next step", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0, 0, -0.2)), 0.5);
    const Real slop = push_slop(scene.gravity, scene.h);
    scene.gap[0] = -0.99 * slop;
    CHECK(scene.solve().push_out[0] == Vec3::Zero());
    scene.gap[0] = -1.01 * slop;
    CHECK(scene.solve().push_out[0].z() > 0);

    RegionTable regions;
    SeparationMemory separation;
    SolverMemory memory;
    std::vector<Index> region(1);
    const auto executor = make_executor(Backend::serial, 1);
    separate_regions(*executor, scene.stencil, scene.inverse_mass, NodeGroups{}, ContactRegions::separate, separation,
                     regions, region);
    std::vector<Vec3> impulse(1), velocity, push(1, Vec3::Zero());
    for (const Real gap : {-1e-3, 0.0}) {
        scene.gap[0] = gap;
        velocity = scene.velocity;
        solve_regions(*executor, scene.inputs(), {}, scene.h, memory, regions, {impulse, velocity, push});
        CHECK((push[0].z() > 0) == (gap < 0));
    }
}

TEST_CASE("a contact that already separates fast enough is not pushed", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0, 0, 1)), 0.5);
    scene.gap[0] = -1e-3;
    const SolvedScene solved = scene.solve();
    CHECK(solved.velocity[0] == Vec3(0, 0, 1));
    CHECK(solved.push_out[0] == Vec3::Zero());
}

}  // namespace skerry::test::solver_push_out_test
