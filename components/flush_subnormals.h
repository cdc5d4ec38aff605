// Treats subnormal numbers (below 1e-38 in single precision) as zero. Processors need a hundred cycles or more for an
// operation on a subnormal number.
#pragma once

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace skerry {

/// While an object of this class exists, the thread that made it treats subnormal inputs and results as zero.
class FlushSubnormals {
public:
#ifdef __SSE2__
    FlushSubnormals() {
        _mm_setcsr(before_ | to_zero_);
    }
    ~FlushSubnormals() {
        _mm_setcsr(before_);
    }

private:
    static constexpr unsigned to_zero_ = 0x8040;  // the bits FTZ (results) and DAZ (inputs) of MXCSR
    unsigned before_ = _mm_getcsr();

public:
#else
    FlushSubnormals() = default;
#endif
    FlushSubnormals(const FlushSubnormals&) = delete;
    FlushSubnormals& operator=(const FlushSubnormals&) = delete;
};

}  // namespace skerry
