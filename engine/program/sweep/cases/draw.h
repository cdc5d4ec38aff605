// Random numbers and equally spaced numbers that are bitwise identical on every machine.
#pragma once

#include <cstdint>
#include <random>

#include "engine/program/sweep/cases/sweep_file.h"

namespace skerry {

/// Random numbers from a seed. The C++ standard prescribes the numbers of its random engine, but its distributions, exp
/// and log differ between libraries. This class therefore has its own distributions.
class Draws {
public:
    explicit Draws(std::uint32_t seed) : engine_(seed) {}
    /// Returns a number uniformly distributed in [0, 1), from the upper 53 bits of one number of the engine.
    double uniform();
    /// Returns a normally distributed number with mean 0 and standard deviation 1 (Marsaglia's polar method). The
    /// second number of the method is discarded.
    double normal();
    /// Returns a random value of a parameter. Unless it is an integer, it is rounded to 12 significant digits.
    double draw(const DrawnEntry& entry);

private:
    std::mt19937_64 engine_;
};

/// Returns the value with index `index`, from 0, of `count` values with linear or logarithmic spacing. The first value
/// is exactly `from` and the last exactly `to`; the others are rounded to 12 significant digits. For logarithmic
/// spacing `from` and `to` must be above 0.
double spaced(double from, double to, int count, int index, Spacing spacing);

/// Natural logarithm of a finite number above 0, and exponential function. Both use only basic arithmetic, so that the
/// results are the same on every machine. The absolute error of log x is below 1e-15 max(1, |log x|), and the relative
/// error of exp x is below 1e-15 max(1, |x|).
double natural_log(double x);
double exponential(double x);

}  // namespace skerry
