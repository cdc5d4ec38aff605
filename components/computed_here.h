// Fixes the place of an operation in the machine code of a kernel.
#pragma once

namespace skerry {

/// Makes gcc compute x at the call, not later: as far as gcc knows, the empty asm statement may change x. Otherwise gcc
/// may delay the operation until x is used, and keep all operands until then. It may also keep results that only rare
/// branches use. Registers then run out, and values go through memory. Without AVX a vector of a kernel does not fit
/// into one register, as the asm constraint requires; x is then returned unchanged.
template <class T>
[[gnu::always_inline]] inline T computed_here(T x) {
#ifdef __BMI2__  // tested instead of __AVX__, which cmake/flags.cmake hides from Eigen
    asm("" : "+v"(x));
#endif
    return x;
}

}  // namespace skerry
