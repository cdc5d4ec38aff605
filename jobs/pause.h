// Short waits without sleeping.
#pragma once

#include <thread>

namespace skerry {

/// Waits for some cycles, in which the other hardware thread of the core can use it alone. On processors other than
/// x86-64 the function yields the core to other threads.
inline void pause_briefly() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#else
    std::this_thread::yield();
#endif
}

}  // namespace skerry
