// The stages of a world access only the data that they declare. With SKERRY_CHECK_ACCESS every scene tests this; the
// test here tests the check itself.
#include <catch2/catch.hpp>

#include "components/check.h"
#include "engine/world/step/step.h"
#include "engine/world/world_state.h"

namespace skerry::test::determinism_access_test {

#ifdef SKERRY_CHECK_ACCESS

TEST_CASE("a stage that uses data that it has not declared fails by name", "[determinism]") {
    WorldState world{Settings{}};
    world.scratch.parameters.h = world.scratch.parameters.kick_time = 1e-3;
    const auto fails_with = [&](const char* message, auto touch) {
        TaskGraph graph;
        graph.track(&world, sizeof world, name_of_column);
        graph.stage(
            "test/liar", [&](std::span<const Real>) { touch(world); }, read(world.model.nodes.mass));
        graph.compile();
        CHECK_THROWS_WITH(graph.run_inline(), Catch::Equals(message));
    };
    fails_with("the stage test/liar reads nodes.velocity without having declared this access",
               [](const WorldState& w) { (void)w.model.nodes.velocity.span(); });
    fails_with("the stage test/liar writes nodes.mass without having declared this access",
               [](WorldState& w) { w.model.nodes.mass.clear(); });
    fails_with("the stage test/liar reads contacts.gap without having declared this access",
               [](const WorldState& w) { (void)w.scratch.contacts.gap.size(); });
    world.graph.stage(
        "test/late", [&world](std::span<const Real>) { world.model.bodies.still_time.clear(); },
        read(world.model.nodes.mass));
    world.graph.compile();
    count_pieces(world);  // as advance() does before each step
    CHECK_THROWS_WITH(world.graph.run_inline(), Catch::Contains("the stage test/late writes bodies.still_time"));
}

#else

// Without SKERRY_CHECK_ACCESS, in builds with NDEBUG, there is nothing to test. The tsan build has it.

#endif

}  // namespace skerry::test::determinism_access_test
