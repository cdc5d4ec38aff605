// Separate or global regions, one worker or eight: permitted and forbidden differences.
#include <catch2/catch.hpp>

#include "tests/support/contact_scene.h"

namespace skerry::test::region_modes_test {

namespace {

/// Regions of many sizes with shuffled contacts. Some contacts penetrate, some are apart, some bounce, some have a warm
/// start.
ContactScene mixed_scene() {
    ContactScene parts;
    for (int k = 0; k < 12; ++k) add_sheets(parts, 3 + k % 5, k % 3 == 0 ? 0 : 0.5, static_cast<unsigned>(k));
    const Index plate = parts.add_node(0, Vec3(0, 0, 0.1));
    for (int k = 0; k < 300; ++k) {
        const Index node = parts.add_node(1 + 0.01 * k, Vec3(0.1 * k, 1, -1 + 0.01 * k));
        if (k % 2 == 0) {
            parts.touch_floor(node, 0.3);
        } else {
            parts.touch_node(node, plate, Vec3(0.1, 0, 1), 0.3);
        }
    }
    ContactScene scene = parts;
    std::vector<std::size_t> order(parts.stencil.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::mt19937 random(5);
    for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random() % (i + 1)]);
    for (std::size_t i = 0; i < order.size(); ++i) {
        scene.stencil[i] = parts.stencil[order[i]];
        scene.normal[i] = parts.normal[order[i]];
        scene.static_friction[i] = scene.dynamic_friction[i] = parts.static_friction[order[i]];
        if (i % 7 == 0) scene.dynamic_friction[i] *= 0.8;
        scene.gap[i] = i % 5 == 0 ? -1e-3 : i % 5 == 1 ? 1e-3 : 0;
        scene.restitution[i] = i % 11 == 0 ? 0.4 : 0;
        scene.impulse[i] = i % 3 == 0 ? Vec3(0.2 * scene.normal[i]) : Vec3(Vec3::Zero());
    }
    return scene;
}

void check_same(const SolvedScene& a, const SolvedScene& b) {
    CHECK(a.velocity == b.velocity);
    CHECK(a.impulse == b.impulse);
    CHECK(a.push_out == b.push_out);
}

}  // namespace

TEST_CASE("with fixed sweeps separate regions and one global region are the same to the last bit",
          "[determinism][solver]") {
    const ContactScene scene = mixed_scene();
    for (const Friction friction : {Friction::cone, Friction::pyramid})
        for (const Index sweeps : {1, 5, 30})
            for (const WarmStart warm : {WarmStart::off, WarmStart::on}) {
                SolverSettings settings;
                settings.method = SolverMethod::pgs;  // acceleration depends on the whole region
                settings.friction = friction;
                settings.fixed_iterations = true;
                settings.max_iterations = sweeps;
                settings.warm_start = warm;
                const SolvedScene separate = scene.solve(settings),
                                  global = scene.solve(settings, ContactRegions::global);
                REQUIRE(separate.regions.size() > 300);
                REQUIRE(global.regions.size() == 1);
                check_same(separate, global);
                CHECK(global.regions.iterations[0] == sweeps);
            }
}

TEST_CASE("the closed form of a single contact is its sweep, to the last bit", "[determinism][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(3, Vec3(0.7, -0.2, -0.3)), 0.4);
    SolverSettings fixed;
    fixed.fixed_iterations = true;
    fixed.max_iterations = 1;
    check_same(scene.solve(), scene.solve(fixed));
}

TEST_CASE("separate and global agree to the tolerance otherwise", "[unit][solver]") {
    const ContactScene scene = mixed_scene();
    SolverSettings settings;
    settings.tolerance = 1e-9;
    settings.max_iterations = 100000;
    const SolvedScene separate = scene.solve(settings), global = scene.solve(settings, ContactRegions::global);
    for (std::size_t n = 0; n < separate.velocity.size(); ++n)
        REQUIRE((separate.velocity[n] - global.velocity[n]).norm() < 1e-5);
}

TEST_CASE("the step has the same bits on any number of workers and any backend", "[determinism][solver]") {
    const ContactScene scene = mixed_scene();
    for (const SolverMethod method : {SolverMethod::ags, SolverMethod::pgs, SolverMethod::pcg_pgs}) {
        SolverSettings settings;
        settings.method = method;
        const SolvedScene one = scene.solve(settings);
        for (const Backend backend : available_backends())
            for (const int workers : {1, 2, 3, 4, 8}) {
                if (backend == Backend::serial && workers > 1) continue;
                const SolvedScene other = scene.solve(settings, ContactRegions::separate, backend, workers);
                check_same(one, other);
                CHECK(std::equal(one.regions.error.begin(), one.regions.error.end(), other.regions.error.begin()));
                CHECK(std::equal(one.regions.iterations.begin(), one.regions.iterations.end(),
                                 other.regions.iterations.begin()));
                CHECK(std::equal(one.regions.dissipated.begin(), one.regions.dissipated.end(),
                                 other.regions.dissipated.begin()));
            }
    }
}

TEST_CASE("memory used before changes nothing", "[determinism][solver]") {
    const ContactScene big = mixed_scene();
    ContactScene small;
    add_sheets(small, 5, 0.5, 77);
    SolverMemory memory;
    const auto executor = make_executor(Backend::serial, 1);
    const auto run = [&](const ContactScene& scene) {
        SolvedScene result;
        SeparationMemory separation;
        std::vector<Index> region(scene.stencil.size());
        separate_regions(*executor, scene.stencil, scene.inverse_mass, NodeGroups{}, ContactRegions::separate,
                         separation, result.regions, region);
        result.impulse = scene.impulse;
        result.velocity = scene.velocity;
        result.push_out.assign(scene.velocity.size(), Vec3::Zero());
        solve_regions(*executor, scene.inputs(), {}, scene.h, memory, result.regions,
                      {result.impulse, result.velocity, result.push_out});
        return result;
    };
    check_same(run(small), small.solve());
    check_same(run(big), big.solve());
    check_same(run(small), small.solve());
}

TEST_CASE("regions are ordered by cost, largest first, ties by number", "[unit][solver]") {
    const SolvedScene solved = mixed_scene().solve();
    const auto size = [&](Index r) { return solved.regions.contacts[static_cast<std::size_t>(r)].size(); };
    std::vector<bool> seen(solved.regions.size(), false);
    for (std::size_t k = 0; k < solved.regions.size(); ++k) {
        const Index r = solved.regions.order[k];
        seen[static_cast<std::size_t>(r)] = true;
        if (k == 0) continue;
        const Index before = solved.regions.order[k - 1];
        REQUIRE((size(before) > size(r) || (size(before) == size(r) && before < r)));
    }
    CHECK(std::find(seen.begin(), seen.end(), false) == seen.end());
}

}  // namespace skerry::test::region_modes_test
