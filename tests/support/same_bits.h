// A world continues bitwise identically with any number of threads, as a clone, and from a file.
#pragma once

#include <catch2/catch.hpp>

#include "skerry/world.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

/// The world of a test object. The object may be the world itself.
World& world_of(auto& object) {
    if constexpr (requires { object.world; })
        return object.world;
    else
        return object;
}

/// `course(threads)` builds a world, or an object with a world, and advances it with one thread and with `threads`.
/// `go_on(world)` advances these worlds and the copies of the first one.
void check_same_bits(auto&& course, auto&& go_on, int threads = 2) {
    auto object = course(1), other = course(threads);
    World& one = world_of(object);
    CHECK(one.state_hash() == world_of(other).state_hash());
    World copy = one.clone();
    const TemporaryFolder folder;
    one.save(folder.path() / "world.skerry");
    World loaded = World::load(folder.path() / "world.skerry");
    for (World* world : {&one, &world_of(other), &copy, &loaded}) {
        go_on(*world);
        CHECK(world->state_hash() == one.state_hash());
    }
}

}  // namespace skerry::test
