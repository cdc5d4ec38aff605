// Loops that reach the peak rates of one core. The build compiles peak_loops.cpp once for each instruction set of the
// kernels, with the compiler options of that set.
#pragma once

#include <cstddef>

namespace skerry::profiling {

/// Repeats x = factor x + summand for independent registers x. Returns the number of floating-point operations.
using FlopLoop = double (*)(std::size_t rounds, double factor, double summand);

/// The loops for one instruction set. Each works on registers of full width.
struct PeakLoops {
    const char* instruction_set;  // name of the instruction set for the compiler, for example x86-64-v3
    std::size_t register_bytes;   // width of a vector register [B]
    // Independent multiplications and additions in double precision, and the same as fused multiply-adds. The fused
    // loops are null if the instruction set has no fused multiply-add.
    FlopLoop separate_double, fused_double;
    FlopLoop separate_single, fused_single;  // the same in single precision
    /// Reads `count` numbers. `count` is a multiple of reals_per_round, and the numbers begin at a full cache line.
    /// Returns a value that depends on all of them.
    double (*read)(const double* from, std::size_t count);
    /// Computes to = x + s y for `count` numbers, with the same conditions as `read`.
    void (*triad)(double* to, const double* x, const double* y, double s, std::size_t count);
};

/// Number of reals that each round of `read` and `triad` processes; a multiple of it must be passed.
inline constexpr std::size_t reals_per_round = 64;

}  // namespace skerry::profiling
