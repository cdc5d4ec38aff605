// Random numbers, vectors and rotations.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <random>

#include "components/types.h"

namespace skerry::test {

/// Uniform numbers in [-1, 1], equal on every machine.
class Random {
public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    Real number() { return static_cast<Real>(bits_() >> 11) * 0x1p-52 - 1; }
    Vec3 vector() {
        const Real x = number(), y = number(), z = number();
        return {x, y, z};
    }
    Mat3 rotation() {
        // Gram-Schmidt on random vectors.
        const Vec3 a = vector().normalized();
        const Vec3 b = a.cross(vector()).normalized();
        Mat3 m;
        m << a, b, a.cross(b);
        return m;
    }

private:
    std::mt19937_64 bits_;
};

}  // namespace skerry::test
