// Start positions of the cubes in the pile of profile_stiff and profile_stiff_peers.
#pragma once

#include <numbers>
#include <random>
#include <vector>

#include "components/types.h"

namespace skerry::profiling {

struct PiledCube {
    Vec3 position;  // [m]
    Vec3 rotation;  // rotation vector [rad]
};

/// Returns 27 cubes, 0.13 m apart, each rotated by up to 8 degrees about a random axis.
inline std::vector<PiledCube> piled_cubes() {
    std::vector<PiledCube> cubes;
    std::mt19937 random(1);
    std::uniform_real_distribution<Real> number(-1, 1);
    for (int z = 0; z < 3; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const Real a = number(random), b = number(random), c = number(random);
                const Real angle = 8 * std::numbers::pi / 180 * number(random);
                cubes.push_back({{0.13 * x, 0.13 * y, 0.08 + 0.13 * z}, angle * Vec3(a, b, c).normalized()});
            }
    return cubes;
}

}  // namespace skerry::profiling
