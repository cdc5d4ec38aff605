// Counts calls of operator new: separating contacts and solving large regions must not allocate when they are repeated.
#include <catch2/catch.hpp>

#include "tests/support/contact_scene.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::solver_allocation_test {

TEST_CASE("large regions are solved without asking for memory, also when they are coloured again", "[unit][solver]") {
    ContactScene scene;
    for (unsigned seed = 0; seed < 2; ++seed) add_sheets(scene, 20, 0.5, seed);
    const Index hub = scene.add_node(30, Vec3(0, 0, 1));
    for (Index n = 0; n < 300; n += 3) scene.touch_node(hub, n, Vec3(0, 0, -1), 0.4);
    for (std::size_t i = 0; i < scene.gap.size(); i += 4) scene.gap[i] = -1e-3;
    SolverSettings settings;
    settings.parallel_region_contacts = 300;
    settings.warm_start = WarmStart::off;
    for (const ExecutorChoice& choice : executor_choices({1, 2})) {
        // libgomp allocates its tasks; the code of the engine is equal for all backends.
        if (choice.backend == Backend::openmp) continue;
        CAPTURE(choice.text());
        const auto executor = choice.make();
        SolvedScene solved;
        SeparationMemory separation;
        SolverMemory memory;
        std::vector<Index> region(scene.stencil.size());
        separate_regions(*executor, scene.stencil, scene.inverse_mass, NodeGroups{}, ContactRegions::separate,
                         separation, solved.regions, region);
        solved.impulse = scene.impulse;
        solved.push_out.assign(scene.velocity.size(), Vec3::Zero());
        solved.velocity = scene.velocity;
        long asked = 0;
        for (int step = 0; step < 20; ++step) {
            scene.stencil[5].weight[3] = step % 4 < 2 ? -0.25 : 0;  // other nodes every two steps
            std::copy(scene.velocity.begin(), scene.velocity.end(), solved.velocity.begin());
            const long before = allocations;
            solve_regions(*executor, scene.inputs(), settings, scene.h, memory, solved.regions,
                          {solved.impulse, solved.velocity, solved.push_out});
            if (step >= 10) asked += allocations - before;
        }
        REQUIRE(solved.regions.iterations[0] > 0);
        CHECK(asked == 0);
    }
}

TEST_CASE("many contacts are separated without asking for memory", "[unit][solver]") {
    ContactScene scene;
    for (unsigned seed = 0; seed < 60; ++seed) add_sheets(scene, 5, 0.5, seed);
    const std::span<const Stencil> all = scene.stencil;
    REQUIRE(all.size() > least_contacts_in_blocks);
    for (const ExecutorChoice& choice : executor_choices({4})) {
        if (choice.backend == Backend::openmp) continue;  // libgomp allocates its tasks
        CAPTURE(choice.text());
        const auto executor = choice.make();
        SeparationMemory memory;
        RegionTable regions;
        std::vector<Index> region(all.size());
        long asked = 0;
        for (int step = 0; step < 20; ++step) {
            const std::size_t count = step % 3 == 0 ? all.size() : all.size() - 60;  // contacts come and go
            const long before = allocations;
            separate_regions(*executor, all.first(count), scene.inverse_mass, NodeGroups{}, ContactRegions::separate,
                             memory, regions, std::span(region).first(count));
            if (step >= 10) asked += allocations - before;
        }
        CHECK(regions.size() >= 50);
        CHECK(asked == 0);
    }
}

}  // namespace skerry::test::solver_allocation_test
