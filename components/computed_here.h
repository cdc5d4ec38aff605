// Fixes the place of an operation in the machine code of a kernel.
#pragma once

namespace skerry {

/// Returns x, and makes gcc compute x here, not later. Otherwise gcc may delay the operation, and keep all its operands
/// until x is used. Registers then run out, and values go through memory.
template <class T>
[[gnu::always_inline]] inline T computed_here(T x) {
#ifdef __BMI2__  // tested instead of __AVX__, which cmake/flags.cmake hides from Eigen
    // This empty statement may change x, as far as gcc knows. It requires that x fits into one vector register. Without
    // AVX a vector of a kernel does not, and x is returned unchanged.
    asm("" : "+v"(x));
#endif
    return x;
}

}  // namespace skerry
