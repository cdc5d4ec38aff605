// Inside and outside by the winding number of the surface.
#include "systems/collision/narrow/winding_number.h"

#include <catch2/catch.hpp>

#include "tests/support/collision_world.h"

namespace skerry::test::winding_number_test {

TEST_CASE("the surface of a body winds once around inner points, and not around outer points", "[unit]") {
    CollisionWorld world;
    world.add_solid(box_mesh({2, 3, 2}, {1, 2, 3}), CollisionWorld::at(Vec3::Zero()), 0.01);
    Random random{5};
    int within = 0;
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3 point = 2 * random.vector();
        const bool is_in = std::abs(point[0]) < 0.5 && std::abs(point[1]) < 1 && std::abs(point[2]) < 1.5;
        CHECK(winding_number(world.inputs(), 0, point) == Approx(is_in ? 1 : 0).margin(1e-12));
        CHECK(is_outside(world.inputs(), 0, point) == !is_in);
        within += is_in;
    }
    CHECK(within > 20);
}

TEST_CASE("where a body overlaps itself the number is two, and such a place is not outside", "[unit]") {
    CollisionWorld world;
    SolidMesh two = box_mesh({1, 1, 1}, {1, 1, 1});
    const SolidMesh other = two;
    const auto first = static_cast<Index>(two.nodes.size());
    for (const Vec3& x : other.nodes) two.nodes.push_back(x + Vec3(0.5, 0, 0));
    for (auto t : other.tetrahedra) {
        for (Index& node : t) node += first;
        two.tetrahedra.push_back(t);
    }
    world.add_solid(two, CollisionWorld::at(Vec3::Zero()), 0.01);
    CHECK(winding_number(world.inputs(), 0, {0.25, 0.1, 0}) == Approx(2));
    CHECK_FALSE(is_outside(world.inputs(), 0, {0.25, 0.1, 0}));
    CHECK(winding_number(world.inputs(), 0, {-0.25, 0.1, 0}) == Approx(1));
    CHECK(is_outside(world.inputs(), 0, {-0.75, 0.1, 0}));
}

}  // namespace skerry::test::winding_number_test
