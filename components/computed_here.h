// Fixes the place of an operation in the machine code of a kernel.
#pragma once

namespace skerry {

/// Returns x, and makes gcc compute x here, not later. Otherwise gcc may delay the operation until x is used, and keep
/// all its operands until then. It may also keep results that only rare branches use. Registers then run out, and
/// values go through memory. The empty asm statement prevents this: as far as gcc knows, it may change x. The statement
/// requires that x fits into one vector register. Without AVX a vector of a kernel does not; x is then returned
/// unchanged.
template <class T>
[[gnu::always_inline]] inline T computed_here(T x) {
#ifdef __BMI2__  // tested instead of __AVX__, which cmake/flags.cmake hides from Eigen
    asm("" : "+v"(x));
#endif
    return x;
}

}  // namespace skerry
