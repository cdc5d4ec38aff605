// SplitMix: random numbers that are the same on every machine.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Random number generator splitmix64 (Steele, Lea, Flood 2014, Fast splittable pseudorandom number generators). Unlike
/// the distributions of the standard library, it yields the same numbers on every machine. The algorithm must not
/// change, because the numbers determine scenes that scatter bodies at random.
class SplitMix {
public:
    explicit SplitMix(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    /// Uniform random number in [0, 1).
    Real fraction() { return static_cast<Real>(next() >> 11) * 0x1p-53; }
    /// Uniform random number in [-1, 1).
    Real symmetric() { return static_cast<Real>(next() >> 11) * 0x1p-52 - 1; }

private:
    std::uint64_t state_;
};

}  // namespace skerry
