// Random numbers that are the same on every machine (splitmix64, Steele et al. 2014): std distributions differ between libraries.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "components/types.h"

namespace skerry::test {

class RandomNumbers {
public:
    explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    /// In [low, high).
    Real within(Real low, Real high) { return low + (high - low) * static_cast<Real>(next() >> 11) * 0x1p-53; }
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

private:
    std::uint64_t state_;
};

}  // namespace skerry::test
