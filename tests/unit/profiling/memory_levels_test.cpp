#include "profiling/roofline/memory_levels.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace skerry::test::memory_levels_test {

using namespace profiling;

TEST_CASE("data lie in the smallest level that holds them", "[unit]") {
    const std::vector<MemoryLevel> levels = memory_levels({32'000, 512'000, 32'000'000}, 1);
    CHECK(level_of(levels, 32'000).name == "L1");
    CHECK(level_of(levels, 32'001).name == "L2");
    CHECK(level_of(levels, 512'001).name == "L3");
    CHECK(level_of(levels, 1e12).name == "memory");
}

TEST_CASE("workers share the L3 cache and have an L1 and L2 cache each", "[unit]") {
    const std::vector<MemoryLevel> levels = memory_levels({32'000, 512'000, 32'000'000}, 8);
    CHECK(level_of(levels, 8 * 32'000).name == "L1");
    CHECK(level_of(levels, 8 * 512'000).name == "L2");
    CHECK(level_of(levels, 32'000'001).name == "memory");
    // The L2 caches of 64 workers hold more than the L3 cache that they share.
    CHECK(level_of(memory_levels({32'000, 512'000, 32'000'000}, 64), 32'700'000).name == "L2");
}

TEST_CASE("sizes of caches are those that Linux describes", "[unit]") {
    const TemporaryFolder folder;
    const auto describe = [&](const char* name, int level, const char* type, const char* size) {
        const std::filesystem::path cache = folder.path() / name;
        std::filesystem::create_directories(cache);
        std::ofstream(cache / "level") << level << '\n';
        std::ofstream(cache / "type") << type << '\n';
        std::ofstream(cache / "size") << size << '\n';
    };
    describe("index0", 1, "Data", "48K");
    describe("index1", 1, "Instruction", "32K");
    describe("index2", 2, "Unified", "1024K");
    describe("index3", 3, "Unified", "32768K");
    const CacheSizes sizes = cache_sizes(folder.path());
    CHECK(sizes.l1 == 48 * 1024);
    CHECK(sizes.l2 == 1024 * 1024);
    CHECK(sizes.l3 == 32768 * 1024);
    CHECK(cache_sizes(folder.path() / "none").l1 == 0);
}

TEST_CASE("a cache of unknown size is left out", "[unit]") {
    const std::vector<MemoryLevel> levels = memory_levels({0, 512'000, 0}, 1);
    REQUIRE(levels.size() == 2);
    CHECK(level_of(levels, 1).name == "L2");
    CHECK(level_of(levels, 1e6).name == "memory");
}

}  // namespace skerry::test::memory_levels_test
