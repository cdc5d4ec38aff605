// Random numbers of the kinds that random scenes are made of, the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "components/split_mix.h"

namespace skerry::test {

class RandomNumbers : public SplitMix {
public:
    using SplitMix::SplitMix;

    /// In [low, high).
    Real within(Real low, Real high) { return low + (high - low) * fraction(); }
    /// In [low, high), every decade as likely as the next.
    Real by_decade(Real low, Real high) { return std::exp(within(std::log(low), std::log(high))); }
    /// From low to high, both included.
    int count(int low, int high) { return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1)); }
    bool chance(Real probability) { return within(0, 1) < probability; }
    /// A direction; along an axis every other time, where faces and edges meet exactly.
    Vec3 direction() {
        if (chance(0.5)) return (chance(0.5) ? 1 : -1) * Vec3::Unit(count(0, 2));
        const Real z = within(-1, 1), angle = within(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }
    template <class T, std::size_t N>
    T one_of(const T (&choices)[N]) {
        return choices[next() % N];
    }
};

}  // namespace skerry::test
