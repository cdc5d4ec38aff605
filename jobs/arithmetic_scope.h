// How floating-point arithmetic is done, for as long as a scope lasts.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace skerry {

/// Sums round to nearest, exceptions are masked, and numbers below 2^-1022 count as zero, as operands and as results;
/// the end of the scope gives the thread back as it was. Blocks and stages run in such a scope, whoever's thread it is,
/// so that all workers calculate alike. Denormal numbers are what motion that decays ends in, and cost a hundred times
/// as much as others (Intel 64 manual, volume 1, 11.6.3). Does nothing on processors without SSE2.
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
    static constexpr unsigned mode = 0x9fc0;  // all exceptions masked, flush to zero, denormals are zero
    unsigned before_;
#endif
};

}  // namespace skerry
