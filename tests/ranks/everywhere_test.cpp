// Every rank holds every body: ranks search for different pairs, and together they find the contacts of one process.
#include <algorithm>
#include <catch2/catch.hpp>
#include <mutex>

#include "engine/world/world_state.h"
#include "tests/ranks/everywhere.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/lively_scene.h"

namespace skerry::test {
namespace {
namespace everywhere_test {

TEST_CASE("each close pair of bodies belongs to one rank", "[ranks]") {
    std::vector<std::uint64_t> alone, divided;
    {
        World world = lively_scene({});
        REQUIRE(world.advance(1e-4).ok());
        const Column<std::uint64_t>& key = WorldAccess::state_of(world).cache.pairs.key;
        alone.assign(key.begin(), key.end());
    }
    std::mutex mutex;
    std::vector<std::size_t> of_rank;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = lively_scene({});
        hold_everywhere(world, ranks);
        REQUIRE(world.advance(1e-4).ok());
        const Column<std::uint64_t>& key = WorldAccess::state_of(world).cache.pairs.key;
        const std::scoped_lock lock(mutex);
        divided.insert(divided.end(), key.begin(), key.end());
        of_rank.push_back(key.size());
    });
    std::ranges::sort(divided);
    CHECK(divided == alone);
    CHECK(std::ranges::min(of_rank) > 0);
}

}  // namespace everywhere_test
}  // namespace
}  // namespace skerry::test
