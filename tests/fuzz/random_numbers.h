// Random numbers for random scenes, equal on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "components/split_mix.h"

namespace skerry::test {

class RandomNumbers : public SplitMix {
public:
    using SplitMix::SplitMix;

    /// A number in [low, high), uniform
    Real within(Real low, Real high) { return low + (high - low) * fraction(); }
    /// A number in [low, high), uniform in its logarithm
    Real by_decade(Real low, Real high) { return std::exp(within(std::log(low), std::log(high))); }
    /// An integer from low to high, both included
    int count(int low, int high) { return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1)); }
    bool chance(Real probability) { return within(0, 1) < probability; }
    /// A unit vector. Half of the time it lies along an axis, so that faces and edges meet exactly.
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
