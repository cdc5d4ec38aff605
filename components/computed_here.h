// Fixes the place of an operation in the machine code of a kernel.
#pragma once

namespace skerry {

/// Returns x, computed at this place of the code, as a value that gcc regards as new. gcc otherwise moves an operation
/// to the use of its result and keeps its operands until then, or keeps results for rare code; both then go through
/// memory. Without AVX a vector of a kernel fills several registers, and x is returned as it is.
template <class T>
[[gnu::always_inline]] inline T computed_here(T x) {
#ifdef __BMI2__  // tested instead of __AVX__, which cmake/flags.cmake hides from Eigen
    asm("" : "+v"(x));
#endif
    return x;
}

}  // namespace skerry
