// Sets the floating-point mode for the lifetime of a scope object.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace skerry {

/// Sets the floating-point mode of the thread until the end of the scope: numbers are rounded to nearest, exceptions
/// are masked, and denormals (magnitudes below 2^-1022) are treated as zero, both as operands and as results. Blocks
/// and stages run in such a scope on every thread, so that all workers compute the same results.
///
/// Decaying motion ends in denormals, and arithmetic with them takes a hundred times as long as with other numbers
/// (Intel 64 manual, volume 1, 11.6.3). Does nothing on processors without SSE2.
class ArithmeticScope {
public:
#if defined(__SSE2__)
    ArithmeticScope() : before_(_mm_getcsr()) {
        if (before_ != mode) _mm_setcsr(mode);
    }
    ~ArithmeticScope() {
        _mm_setcsr(before_);
    }
#else
    ArithmeticScope() = default;
#endif
    ArithmeticScope(const ArithmeticScope&) = delete;
    ArithmeticScope& operator=(const ArithmeticScope&) = delete;

private:
#if defined(__SSE2__)
    // MXCSR: rounds to nearest, masks all exceptions, flushes to zero, reads denormals as 0
    static constexpr unsigned mode = 0x9fc0;
    unsigned before_;
#endif
};

}  // namespace skerry
