// Stress suite: worlds with almost no content (item 24 of docs/stress.md).
#include <catch2/catch.hpp>

#include "tests/support/stress.h"

namespace skerry::test::nearly_nothing_test {

using namespace skerry::test::stress;

TEST_CASE("worlds with nothing, nothing that moves, one tetrahedron or no contact run", "[scene][stress]") {
    const auto judge_run = [](const std::string& name, World& world, bool contacts) {
        const Course course = follow(world, 0.1, 5);
        const bool quiet = contacts || world.report().max_contacts == 0;
        judge({24, name + ", 0.1 s", "every step taken, finite, time goes on", course.ok ? "all steps" : course.message,
               course.ok && course.finite && quiet && world.time() == Approx(0.1)});
    };
    {
        World empty;
        judge_run("empty scene", empty, false);
    }
    {
        World world;
        world.add_collider(Plane{});
        world.add_collider(mesh::boundary(mesh::box({1, 1, 1}, {1, 1, 1})), {.motion = {.velocity = {1, 0, 0}}});
        judge_run("colliders alone, one of them moving", world, false);
    }
    {
        World world;
        const auto material = world.add_material({});
        world.add_collider(Plane{});
        const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
        const auto body = world.add_body(mesh, {.material = material, .position = {0, 0, 0.05}, .velocity = {1, 1, 1}});
        std::vector<Index> all(mesh.nodes.size());
        for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Index>(n);
        world.attach(body, all);
        const Vec3 before = world.positions(body)[0];
        judge_run("a body all of whose nodes are held, on a plane", world, true);
        CHECK(world.positions(body)[0] == before);
    }
    Mesh one;
    one.nodes = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    one.tetrahedra = {{0, 1, 2, 3}};
    for (const bool floor : {true, false}) {
        World world;
        const auto material = world.add_material({.damping = 10});
        if (floor) world.add_collider(Plane{});
        world.add_body(one, {.material = material, .position = {0, 0, 0.01}});
        judge_run(floor ? "one tetrahedron dropped on a plane" : "one tetrahedron, no contact", world, floor);
        const StepReport none = world.advance(0);
        judge({24, "a step of no time", "nothing happens", text(none.steps) + " steps", none.ok() && none.steps == 0});
    }
}

}  // namespace skerry::test::nearly_nothing_test
