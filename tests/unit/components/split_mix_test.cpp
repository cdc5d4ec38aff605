#include "components/split_mix.h"

#include <catch2/catch.hpp>

namespace skerry::test::split_mix_test {

TEST_CASE("the generator is the published splitmix64", "[unit]") {
    SplitMix numbers(1234567);  // the first numbers of Vigna's reference implementation, https://prng.di.unimi.it
    CHECK(numbers.next() == 6457827717110365317ull);
    CHECK(numbers.next() == 3203168211198807973ull);
    CHECK(numbers.next() == 9817491932198370423ull);
}

TEST_CASE("fractions lie from 0 to 1 and symmetric numbers from -1 to 1, the upper end left out", "[unit]") {
    SplitMix numbers(1);
    Real least = 1, most = 0, lowest = 1, highest = -1;
    for (int i = 0; i < 10000; ++i) {
        const Real fraction = numbers.fraction(), symmetric = numbers.symmetric();
        least = std::min(least, fraction), most = std::max(most, fraction);
        lowest = std::min(lowest, symmetric), highest = std::max(highest, symmetric);
    }
    CHECK((least >= 0 && least < 1e-3));
    CHECK((most < 1 && most > 1 - 1e-3));
    CHECK((lowest >= -1 && lowest < -1 + 2e-3));
    CHECK((highest < 1 && highest > 1 - 2e-3));
}

}  // namespace skerry::test::split_mix_test
