#include "systems/geometry/lane_mask.h"

#include <catch2/catch.hpp>
#include <vector>

namespace skerry::test::lane_mask_test {

TEST_CASE("a comparison of eight lanes gives the bit of each, in rising order", "[unit]") {
    for (unsigned pattern = 0; pattern < 1U << element_lanes; ++pattern) {
        Real8 value{};
        std::vector<std::size_t> expected, visited;
        for (std::size_t l = 0; l < element_lanes; ++l) {
            value[static_cast<int>(l)] = (pattern >> l & 1U) != 0 ? 1 : -1;
            if ((pattern >> l & 1U) != 0) expected.push_back(l);
        }
        const Real8 none{};
        CHECK(bits_of(value > none) == pattern);
        const Real4 low = __builtin_shufflevector(value, value, 0, 1, 2, 3);
        CHECK(bits_of(low > Real4{}) == (pattern & 15U));
        Lanes<Real, element_lanes> stored;
        store(value, stored);
        CHECK(bits_of_parts([&](std::size_t part) { return load_part<KernelReal>(stored, part) > 0.0; }) == pattern);
        for_each_lane(bits_of(value > none), [&](std::size_t l) { visited.push_back(l); });
        CHECK(visited == expected);
    }
}

}  // namespace skerry::test::lane_mask_test
