// Short waits without sleeping.
#pragma once

#include <thread>

namespace skerry {

/// Lets the other hardware thread of the core run for some cycles. On processors other than x86-64 it yields the core.
inline void pause_briefly() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#else
    std::this_thread::yield();
#endif
}

}  // namespace skerry
