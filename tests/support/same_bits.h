// A world continues bitwise identically with any number of threads, as a clone, and from a file.
#pragma once

#include <catch2/catch.hpp>

#include "skerry/world.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

/// `course(threads)` builds an object with a world and advances it; `go_on(world)` advances that world and its copies.
void check_same_bits(auto&& course, auto&& go_on) {
    auto one = course(1), two = course(2);
    CHECK(one.world.state_hash() == two.world.state_hash());
    World copy = one.world.clone();
    const TemporaryFolder folder;
    one.world.save(folder.path() / "world.skerry");
    World loaded = World::load(folder.path() / "world.skerry");
    for (World* world : {&one.world, &two.world, &copy, &loaded}) {
        go_on(*world);
        CHECK(world->state_hash() == one.world.state_hash());
    }
}

}  // namespace skerry::test
