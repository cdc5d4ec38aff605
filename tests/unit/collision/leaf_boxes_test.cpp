#include "systems/collision/tree/leaf_boxes.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "tests/support/collision_world.h"

namespace skerry::test::leaf_boxes_test {

namespace {

Aabb random_box(test::Random& random) {
    Aabb box = empty_box();
    for (int i = 0; i < 2; ++i) grow(box, random.vector());
    return box;
}

Real lane_of_parts(const Parts<KernelReal>& parts, std::size_t lane) {
    return parts[lane / lanes_of<KernelReal>][lane % lanes_of<KernelReal>];
}

}  // namespace

TEST_CASE("eight boxes against one are as far as each of them alone, to the last bit", "[unit]") {
    test::Random random(11);
    int overlapping = 0;
    for (int round = 0; round < 200; ++round) {
        LeafBoxes leaf = empty_leaf();
        for (std::size_t l = 0; l < leaf_lanes; ++l) set_lane(leaf, l, random_box(random));
        const Aabb other = random_box(random);
        const Parts<KernelReal> squared = distance_squared(leaf, other);
        unsigned near = 0;
        for (std::size_t l = 0; l < leaf_lanes; ++l) {
            const Real alone = distance_squared(lane_of(leaf, l), other);
            CHECK(lane_of_parts(squared, l) == alone);
            near |= static_cast<unsigned>(alone < 0.1) << l;
            overlapping += alone == 0;
        }
        CHECK(lanes_below(squared, 0.1) == near);
    }
    CHECK(overlapping > 50);
}

TEST_CASE("empty lanes are near nothing, and lanes with NaN are near all features", "[unit]") {
    constexpr Real infinite = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
    const Aabb unit{Vec3::Zero(), Vec3::Ones()};
    LeafBoxes leaf = empty_leaf();
    CHECK(lanes_below(distance_squared(leaf, unit), std::numeric_limits<Real>::max()) == 0);
    CHECK(lanes_below(distance_squared(leaf, empty_box()), infinite) == 0);
    set_lane(leaf, 3, unit);
    const Aabb nowhere{Vec3::Constant(nan), Vec3::Constant(nan)};
    CHECK(lane_of_parts(distance_squared(leaf, nowhere), 3) == distance_squared(unit, nowhere));
    CHECK((lanes_below(distance_squared(leaf, nowhere), 1) & 8U) != 0);  // NaN counts as near
}

TEST_CASE("lanes are visited in rising order", "[unit]") {
    std::vector<std::size_t> seen;
    for_each_lane(0b10010011, [&](std::size_t lane) { seen.push_back(lane); });
    CHECK(seen == std::vector<std::size_t>{0, 1, 4, 7});
    for_each_lane(0, [](std::size_t) { FAIL("nothing to visit"); });
}

}  // namespace skerry::test::leaf_boxes_test
