// A box full of balls: the scene with enough bodies for many cores, in any size.
#pragma once

#include <filesystem>

#include "skerry/world.h"

namespace skerry::profiling {

struct PileShape {
    int balls_per_edge = 10;  // of the cube of balls that falls
    double gap = 0.03;        // between neighbours, in diameters
    bool falls = true;        // else they float apart and touch nothing
};

/// Rubber balls of the given mesh, each turned its own way, as in scenes/drop, but close to each other, so that they
/// touch soon.
World make_pile(const PileShape& shape, const Mesh& ball, int threads);

}  // namespace skerry::profiling
