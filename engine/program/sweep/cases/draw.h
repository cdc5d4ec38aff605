// Numbers that are drawn or spaced, the same to the last bit on every machine.
#pragma once

#include <cstdint>
#include <random>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

/// The engine is the standard's, whose numbers are prescribed; what is made of them is not left to the library: its
/// distributions, and its exp and log in their last bits, differ from one to the next.
class Draws {
public:
    explicit Draws(std::uint32_t seed) : engine_(seed) {}
    /// From 0 to below 1: the upper 53 bits of one draw.
    double uniform();
    /// Mean 0, standard deviation 1 (Marsaglia's polar method, whose second number is given away).
    double normal();
    /// A value of the parameter, to 12 digits.
    double draw(const DrawnEntry& entry);

private:
    std::mt19937_64 engine_;
};

/// Value `index` of `count` from `from` to `to`, which are exact; to 12 digits. Of log, both are above 0.
double spaced(double from, double to, int count, int index, Spacing spacing);

/// Logarithm of a finite number above 0, and exponential, in plain arithmetic: right to 1e-15, relative to the larger
/// of 1 and the argument.
double natural_log(double x);
double exponential(double x);

}  // namespace skerry
