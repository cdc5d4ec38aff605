// Estimate of the time that a run still needs.
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/program/time_left.h"

namespace skerry::test::time_left_test {

TEST_CASE("at a constant pace the time left is exact", "[unit]") {
    TimeLeft left(10, 2);
    CHECK(!std::isfinite(left.estimate()));
    for (int k = 1; k <= 1000; ++k) left.reach(0.003 * k, 2 + 0.004 * k);
    // 4 of 8 s are simulated in 3 s.
    CHECK(left.estimate() == Approx(3));
    left.reach(6, 10);
    CHECK(left.estimate() == 0);
}

TEST_CASE("the time left follows a pace that changes", "[unit]") {
    TimeLeft left(3);
    for (int k = 1; k <= 1000; ++k) left.reach(0.001 * k, 0.001 * k);  // 1 s in 1 s
    CHECK(left.estimate() == Approx(2));
    for (int k = 1; k <= 1000; ++k) left.reach(1 + 0.009 * k, 1 + 0.001 * k);  // then 1 s in 9 s
    // The mean pace is 5, and that of the last half is 9. Samples are 5 % apart.
    CHECK(left.estimate() == Approx(std::sqrt(5.0 * 9)).epsilon(0.02));
    left.reach(100, 2);  // no progress for a long time
    CHECK(left.estimate() == Approx(50));
}

}  // namespace skerry::test::time_left_test
