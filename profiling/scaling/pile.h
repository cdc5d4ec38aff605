// Scene with enough bodies for many cores: a box full of balls, of any size.
#pragma once

#include <filesystem>

#include "skerry/world.h"

namespace skerry::profiling {

struct PileShape {
    int balls_per_edge = 10;  // number of balls along an edge of their cube
    double gap = 0.03;        // gap between neighbours, in diameters
    bool falls = true;        // false: they float apart and touch nothing
};

/// Builds rubber balls of the given mesh, each with its own rotation. The scene is like scenes/drop, but the balls
/// start close to each other so that they touch soon.
World make_pile(const PileShape& shape, const Mesh& ball, int threads);

}  // namespace skerry::profiling
