// Random and equally spaced numbers, bitwise identical on every machine.
#pragma once

#include <cstdint>
#include <random>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

/// The standard prescribes the numbers of its random engine. Its distributions, and the last bits of exp and log,
/// differ between libraries. This class therefore computes them itself.
class Draws {
public:
    explicit Draws(std::uint32_t seed) : engine_(seed) {}
    /// Uniform in [0, 1), from the upper 53 bits of one draw.
    double uniform();
    /// Normal with mean 0 and standard deviation 1 (Marsaglia's polar method; its second number is discarded).
    double normal();
    /// Draws a value of the parameter, rounded to 12 digits.
    double draw(const DrawnEntry& entry);

private:
    std::mt19937_64 engine_;
};

/// Value `index` of `count` values from `from` to `to`, inclusive and exact; others are rounded to 12 digits. For
/// logarithmic spacing both ends are above 0.
double spaced(double from, double to, int count, int index, Spacing spacing);

/// Logarithm of a finite number above 0, and exponential function, in plain arithmetic. Accurate to 1e-15, relative to
/// the larger of 1 and the argument.
double natural_log(double x);
double exponential(double x);

}  // namespace skerry
