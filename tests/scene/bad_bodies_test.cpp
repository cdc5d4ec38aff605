// Bodies that are refused, with what is wrong with them.
#include <catch2/catch.hpp>
#include <utility>

#include "skerry/world.h"

using namespace skerry;
using Catch::Contains;

namespace {

/// Two regular corners, one on each side of the plane z = 0.
Mesh two_sided() {
    return {.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)},
            .tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}}};
}

}  // namespace

TEST_CASE("tetrahedra that lie in each other are refused by their numbers", "[scene]") {
    World world;
    const MaterialHandle rubber = world.add_material({});
    CHECK_NOTHROW(world.add_body(two_sided(), {.material = rubber}));

    Mesh twice = two_sided();
    twice.tetrahedra.push_back({2, 0, 1, 3});  // the first one again
    CHECK_THROWS_WITH(world.add_body(twice, {.material = rubber, .name = "twice"}),
                      Contains("body 'twice'") && Contains("tetrahedra 0 and 2 on the same side of a face"));

    Mesh inside = two_sided();
    inside.nodes.push_back(Vec3(0.2, 0.2, 0.2));
    inside.tetrahedra.push_back({0, 1, 2, 5});  // within the first one, on its ground
    CHECK_THROWS_WITH(world.add_body(inside, {.material = rubber}), Contains("tetrahedra 0 and 2 on the same side"));
    CHECK(world.bodies().size() == 1);
}
